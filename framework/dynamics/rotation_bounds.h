/// How fast a tumbling body can turn at most, from what its free motion conserves.
#pragma once

#include "framework/dynamics/body.h"

namespace tumble {

struct RotationBounds {
  double angular_speed;          // of |omega| [rad/s]
  double angular_acceleration;   // of |d omega/dt| [rad/s^2]
};

/// Holds for the whole free motion of a rigid body with these moments and this angular momentum, and under a torque that is
/// at most `torque_bound` for `duration`. Energy 2T = sum I_i x_i and momentum L^2 = sum I_i^2 x_i, x_i = w_i^2 >= 0, leave a
/// segment of x; |w|^2 = sum x_i is linear on it, so its ends bound it (the needle whose L / I_min is a million times its speed
/// costs nothing). Source: H. Goldstein, Classical Mechanics, sec. 5.6 (polhode).
/// @param torque_bound [N m], duration [s]
RotationBounds bound_rotation(const RigidBodyState& state, const Inertia& inertia, double torque_bound, double duration);

}  // namespace tumble
