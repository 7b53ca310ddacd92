/// How a solid moves for a while, with what bounds it: what guarantees about times of impact stand on.
#pragma once

#include <functional>

#include "framework/collision/collision_shape.h"

namespace tumble::collision {

/// Place and velocity at one instant. World frame.
struct MotionState {
  Pose pose;
  Vector3d velocity_world = Vector3d::Zero();  // of the centre of mass [m/s]
  Vector3d omega_world = Vector3d::Zero();     // [rad/s]
};

/// What holds during the whole interval that is asked about.
struct MotionBounds {
  Vector3d acceleration_world = Vector3d::Zero();  // constant part of the centre's acceleration, exact [m/s^2]
  double acceleration_deviation = 0.0;             // largest length of what the acceleration has beside it [m/s^2]
  double angular_speed = 0.0;                      // largest |omega| [rad/s]
  double angular_acceleration = 0.0;               // largest |d omega/dt| [rad/s^2]
  double angular_velocity_error = 0.0;             // largest |stated omega - rate of the path| (numerical paths) [rad/s]
};

struct Motion {
  std::function<MotionState(double t)> at;
  MotionBounds bounds;
};

}  // namespace tumble::collision
