/// Motions for tests of impacts.
#pragma once

#include "framework/collision/first_impact.h"

namespace tumble::testing {

/// Uniform acceleration and uniform spin about a fixed axis.
inline collision::Motion flight(const Vector3d& x0, const Vector3d& v0,
                                const Vector3d& acceleration, const Vector3d& omega,
                                const Quaterniond& q0 = Quaterniond::Identity()) {
  collision::Motion motion;
  motion.at = [=](double t) {
    collision::MotionState state;
    state.pose.com_world = x0 + (v0 + 0.5 * t * acceleration) * t;
    const double angle = omega.norm() * t;
    state.pose.world_from_body =
        angle != 0 ? Quaterniond(Eigen::AngleAxisd(angle, omega.normalized())) * q0 : q0;
    state.velocity_world = v0 + t * acceleration;
    state.omega_world = omega;
    return state;
  };
  motion.bounds.acceleration_world = acceleration;
  motion.bounds.angular_speed = omega.norm();
  return motion;
}

/// As a method of integration gives it: the path turns at omega + error, its states say omega.
inline collision::Motion numerical(const Vector3d& x0, const Vector3d& v0,
                                   const Vector3d& acceleration, const Vector3d& omega,
                                   const Vector3d& error, const Quaterniond& q0) {
  collision::Motion motion = flight(x0, v0, acceleration, omega + error, q0);
  motion.at = [at = motion.at, omega](double t) {
    collision::MotionState state = at(t);
    state.omega_world = omega;
    return state;
  };
  motion.bounds.angular_speed = omega.norm();
  motion.bounds.angular_velocity_error = error.norm();
  return motion;
}

}  // namespace tumble::testing
