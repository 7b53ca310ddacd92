/// The motion of a solid over an interval, with bounds on it that guarantee the first time of
/// impact.
#pragma once

#include <functional>

#include "framework/collision/collision_shape.h"

namespace tumble::collision {

/// Pose and velocity at one instant. World frame.
struct MotionState {
  Pose pose;
  Vector3d velocity_world = Vector3d::Zero();  // of the centre of mass [m/s]
  Vector3d omega_world = Vector3d::Zero();     // [rad/s]
};

/// Bounds that hold during the whole interval.
struct MotionBounds {
  // constant part of the centre's acceleration, exact [m/s^2]
  Vector3d acceleration_world = Vector3d::Zero();
  // largest length of the rest of the acceleration [m/s^2]
  double acceleration_deviation = 0.0;
  double angular_speed = 0.0;         // largest |omega| [rad/s]
  double angular_acceleration = 0.0;  // largest |d omega/dt| [rad/s^2]
  // largest |omega of the state - angular velocity of the path| (numerical paths) [rad/s]
  double angular_velocity_error = 0.0;
};

struct Motion {
  std::function<MotionState(double t)> at;
  MotionBounds bounds;
};

}  // namespace tumble::collision
