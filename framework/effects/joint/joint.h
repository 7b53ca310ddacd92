/// Joint: two bodies, or a body and the world, that share a point (ball), an axis besides (hinge),
/// or are one (weld). Its rows: joint_rows.h.
#pragma once

#include <cstdint>
#include <string>

#include "framework/dynamics/world.h"

namespace tumble::effects {

enum class JointKind : std::uint8_t { kBall, kHinge, kWeld };

/// What a scene says of it.
struct JointSpec {
  std::string name;
  JointKind kind = JointKind::kBall;
  std::string body_a, body_b;           // body_b "": the world
  Vector3d point_m = Vector3d::Zero();  // world, at the start
  Vector3d axis = Vector3d::UnitZ();    // unit, world, at the start; of a hinge
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// What a world holds of it.
struct JointLink {
  std::string name;
  JointKind kind;
  Anchor a, b;  // the shared point
  // frame fixed in each body (b: in the world for body -1); a hinge turns about its z
  Quaterniond a_from_joint, b_from_joint;
};

}  // namespace tumble::effects
