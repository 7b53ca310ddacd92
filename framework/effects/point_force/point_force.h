/// Point force: a constant force on a point fixed in a body, for a while (what a hand or a user's
/// click does).
///   F constant,    tau = (p - c) x F
///       (p: the point, c: the centre of mass, world frame; the law wrench_of_point_force)
#pragma once

#include <string>

#include "framework/core/math.h"

namespace tumble::effects {

/// What a scene says of it.
struct PointForceSpec {
  std::string body;
  Vector3d force_n;  // world frame, constant
  Vector3d point_m;  // world position of the point at start_s
  double start_s = 0.0;
  double duration_s = 0.0;
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// What a world holds of it.
struct PointForce {
  int body;
  Vector3d force_world;  // [N]
  Vector3d point_world;  // where the point is at `start` [m]
  double start, end;     // it acts in [start, end) [s]
};

}  // namespace tumble::effects
