/// How fast a tumbling body can turn at most, from what its motion conserves.
#pragma once

#include "framework/dynamics/body.h"

namespace tumble {

struct RotationBounds {
  double angular_speed;         // of |omega| [rad/s]
  double angular_acceleration;  // of |d omega/dt| [rad/s^2]
};

/// What keeps a motion from being free and exact, and for how long.
struct Disturbance {
  double duration;      // [s]
  double torque = 0.0;  // largest length [N m]
  // largest |rate at which the body is turned - omega of its state| (numerical paths) [rad/s]
  double angular_velocity_error = 0.0;
};

/// A body's moments about its principal axes, ascending, and these axes as columns, body frame.
struct PrincipalMoments {
  Vector3d moments;  // [kg m^2]
  Matrix3d axes_body;
};
/// @pre inertia is finite
PrincipalMoments principal_moments(const Inertia& inertia);

/// Bounds on omega = I^-1 L, the angular velocity of the body's state, for the whole duration.
/// Energy 2T = sum I_i x_i and momentum L^2 = sum I_i^2 x_i, x_i = w_i^2 >= 0, leave a segment of
/// x; |w|^2 = sum x_i is linear on it, so its ends bound it (the needle whose L / I_min is a
/// million times its speed costs nothing). A torque and a path that is turned at omega + e instead
/// of omega widen both to bands:
///   |d sqrt(2T)/dt| <= |torque| / sqrt(I_min),
///       |d(2T)/dt| = 2 |e . (omega x L)| <= 2 |e| |omega| |L|                                (D.1)
///   |d omega/dt| <= |I^-1 (L x omega)| + |torque| / I_min + |e| (|omega| + |L| / I_min)      (D.2)
/// @pre inertia is finite; nothing is assumed of the size of the disturbances. Always angular_speed
/// <= largest |L| / I_min.
/// Source: H. Goldstein, Classical Mechanics, sec. 5.6 (polhode).
RotationBounds bound_rotation(const RigidBodyState& state, const Inertia& inertia,
                              const Disturbance& disturbance);
/// The same for a caller that asks often. @param principal  principal_moments(inertia)
RotationBounds bound_rotation(const RigidBodyState& state, const Inertia& inertia,
                              const PrincipalMoments& principal, const Disturbance& disturbance);

}  // namespace tumble
