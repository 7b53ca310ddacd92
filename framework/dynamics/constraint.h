/// Springs, rods and the rows of constraints as equations see them. Plain data, light enough for a
/// student's file.
///
/// Frames and units as in body.h. A velocity or a force on a body as six numbers is (linear,
/// angular): (v, omega) [m/s, rad/s], (F, tau about the centre of mass) [N, N m], all in the world
/// frame.
/// Sources: D. Baraff, "Linear-time dynamics using Lagrange multipliers", SIGGRAPH 1996; A. Witkin,
/// "Constrained dynamics", SIGGRAPH course notes 1997.
#pragma once

#include <vector>

#include "framework/dynamics/body.h"

namespace tumble {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A damped spring without mass.
struct Spring {
  double stiffness = kUnset;  // k >= 0 [N/m]
  // c >= 0 [N s/m], along the spring
  double damping = kUnset;
  double rest_length = kUnset;  // L0 >= 0 [m]; 0 is allowed
};

/// Where an anchor is and how it moves: a point fixed in a body, or in the world (velocity 0).
struct AnchorState {
  Vector3d point_world = unset_vector();     // (3) [m]
  Vector3d velocity_world = unset_vector();  // (3) [m/s]
};

/// One scalar equation C(x_a, x_b) = 0 on the places of two bodies A and B, linearised where they
/// are.
///   C' = J_a . u_a + J_b . u_b,      C'' = J_a . u_a' + J_b . u_b' + (J' u)
struct ConstraintRow {
  // J_a, (6): (linear, angular), world
  Vector6d jacobian_a = Vector6d::Constant(kUnset);
  Vector6d jacobian_b = Vector6d::Constant(kUnset);  // J_b, (6)
  // C: what is wrong with the places now [m, or rad]
  double value = kUnset;
  double rate = kUnset;  // C' [m/s]
  // J' u: what C'' is where nothing accelerates [m/s^2]
  double velocity_product = kUnset;
};

/// Whether it speaks of directions alone, in rad: it pushes neither body, it turns them.
inline bool is_of_directions(const ConstraintRow& row) {
  return row.jacobian_a.head<3>().isZero(0) && row.jacobian_b.head<3>().isZero(0);
}

/// A row between two bodies of a list. A multiplier lambda pushes A with lambda J_a and B with
/// lambda J_b.
struct Constraint {
  // indices into the list of bodies; different
  int body_a = 0;
  int body_b = 0;
  ConstraintRow row;
};

/// A body as constraints see it. One of infinite mass has inverse mass 0 and zero inverse inertia:
/// no constraint accelerates it, but it may be driven, and then free_acceleration is its drive's.
struct ConstrainedBody {
  double inverse_mass = kUnset;                                 // [1/kg]
  Matrix3d inverse_inertia_world = Matrix3d::Constant(kUnset);  // (3,3), world [1/(kg m^2)]
  // u' without the constraints' forces [m/s^2, rad/s^2]
  Vector6d free_acceleration = Vector6d::Constant(kUnset);
};

}  // namespace tumble
