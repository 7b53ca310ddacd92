/// A rigid body as the equations see it. Plain data, light enough for a student's file.
///
/// Frames: `world` is inertial, right-handed, z up; `body` has its origin at the centre of mass and
/// turns with the body. Units: SI. Orientation: unit Hamilton quaternion, body to world.
#pragma once

#include "framework/core/math.h"

namespace tumble {

inline Vector3d unset_vector() { return Vector3d::Constant(kUnset); }

/// How a body resists being moved.
/// A body of infinite mass (a wall, the floor) has inverse_mass 0 and zero inverse_inertia_body;
/// its mass is +infinity and its inertia_body is not to be used.
struct Inertia {
  double mass = kUnset;          // [kg], > 0 or +infinity
  double inverse_mass = kUnset;  // [1/kg], >= 0
  // (3,3), body frame, about the centre of mass [kg m^2]
  Matrix3d inertia_body = Matrix3d::Constant(kUnset);
  Matrix3d inverse_inertia_body = Matrix3d::Constant(kUnset);  // (3,3), body frame [1/(kg m^2)]
};

/// @param inertia_body  (3,3), symmetric positive definite, body frame, about the centre of mass
/// [kg m^2]
/// @pre mass > 0 and finite
Inertia finite_inertia(double mass, const Matrix3d& inertia_body);
/// A body that nothing can push: inverse mass and inverse inertia are zero.
Inertia infinite_inertia();

/// State of the equations of motion (Baraff, SIGGRAPH course notes 1997, part I, eq. 2-16).
struct RigidBodyState {
  Vector3d com_world = unset_vector();                          // (3), centre of mass [m]
  Quaterniond world_from_body{kUnset, kUnset, kUnset, kUnset};  // unit, Hamilton, w first
  Vector3d momentum_world = unset_vector();                     // (3), P = m v [kg m/s]
  // (3), L = I w about the centre of mass [kg m^2/s]
  Vector3d angular_momentum_world = unset_vector();
};

/// A body at the instant of an impact: what impulses need.
struct Body {
  Inertia inertia;
  Vector3d com_world = unset_vector();                          // (3), centre of mass [m]
  Quaterniond world_from_body{kUnset, kUnset, kUnset, kUnset};  // unit, Hamilton
  // (3), of the centre of mass [m/s]
  Vector3d velocity_world = unset_vector();
  Vector3d omega_world = unset_vector();  // (3), angular velocity [rad/s]
};

/// Linear and angular velocity of a body, world frame.
struct Velocity {
  // (3), of the centre of mass [m/s]
  Vector3d linear_world = unset_vector();
  Vector3d angular_world = unset_vector();  // (3) [rad/s]
};

/// A force on the centre of mass together with a torque about it, world frame.
struct Wrench {
  Vector3d force_world = unset_vector();  // (3) [N]
  // (3), about the centre of mass [N m]
  Vector3d torque_world = unset_vector();
};

/// One point at which two bodies touch.
struct Contact {
  Vector3d point_world = unset_vector();          // (3) [m]
  Vector3d normal_b_to_a_world = unset_vector();  // (3), unit, from B to A [-]
};

/// Half-line origin + t direction, t >= 0. The direction need not be unit; t counts in lengths of
/// it.
struct Ray {
  Vector3d origin_world = unset_vector();     // (3) [m]
  Vector3d direction_world = unset_vector();  // (3), not zero
};

/// Corners in counter-clockwise order seen from the front.
struct Triangle {
  Vector3d a_world = unset_vector();
  Vector3d b_world = unset_vector();
  Vector3d c_world = unset_vector();
};

/// Where a ray meets a triangle.
struct RayHit {
  // >= 0, in lengths of the ray's direction [-]
  double t = kUnset;
  // (3), weights of a, b, c; sum 1; each in [0, 1]
  Vector3d barycentric = unset_vector();
};

}  // namespace tumble
