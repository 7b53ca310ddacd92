/// A link between two bodies as a joint that an articulated tree may hang them on.
#pragma once

#include <cstdint>

#include "framework/dynamics/body.h"

namespace tumble {

enum class TreeJoint : std::uint8_t { kFree, kBall, kHinge, kWeld, kRod };

/// A link between two bodies of a list, or of one and a fixed end (places behind the bodies').
struct TreeLink {
  TreeJoint kind = TreeJoint::kBall;
  int a = -1, b = -1;
  // anchors: body frame [m]
  Vector3d point_a_body = Vector3d::Zero(), point_b_body = Vector3d::Zero();
  double length = 0.0;  // of a rod, > 0 [m]
  // of a hinge and a weld: the joint's frame in both, a hinge turns about its z
  Quaterniond a_from_joint = Quaterniond::Identity(), b_from_joint = Quaterniond::Identity();
  int row = 0, row_count = 0;  // its rows among those of all links
};

}  // namespace tumble
