/// Assignment 2, Integration: what you write. Theory, hints and points: handouts/a2_integration.md.
/// Your file: a2_integration.cpp.
///
/// From forces to motion: a step of Euler's method and of the classical Runge-Kutta method, the
/// derivative of a rigid body's state that they integrate, and the repairs that keep an orientation
/// a rotation. From motion to the time of impact: bisection, and Newton-Raphson with a safeguard.
///
/// Terms, symbols and sources: handouts/notation.md.
/// Frames: `world` is inertial, right-handed, z up; `body` has its origin at the centre of mass and
/// turns with the body. Orientation: unit Hamilton quaternion q = (w, x, y, z), or the matrix R
/// with the same meaning: v_world = R v_body. Units SI, angles in radians. A body of infinite mass
/// has inverse_mass 0 and a zero inverse_inertia_body: use these two and every formula below holds
/// for it; do not use its mass (+infinity) or its inertia_body.
/// Sources, cited below by name:
///   Baraff   D. Baraff, "Rigid body simulation" I, SIGGRAPH course notes, 1997
///   Hairer   E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential Equations" I,
///            1993
///   Golub    G. Golub, C. Van Loan, "Matrix Computations", 2013
///   Diebel   J. Diebel, "Representing attitude: Euler angles, unit quaternions, and rotation
///            vectors", Stanford, 2006
///   NR       W. Press et al., "Numerical Recipes", 2007
#pragma once

#include "framework/core/not_implemented.h"
#include "framework/dynamics/body.h"
#include "framework/dynamics/ode.h"
#include "framework/modules/answer_sizes.h"
#include "framework/modules/module.h"

namespace tumble::a2 {

// ---- One step of an ordinary differential equation y' = f(t, y) ---------------------------------

/// One step of Euler's method: along the tangent at the start.
///   y(t + h) ~ y + h f(t, y)                                                                (A2.1)
/// Order 1: halving h halves the error. It gains energy in an undamped oscillation at every step
/// size.
/// @param f  right-hand side: (n), units of y per second; may depend on t. Call it exactly once: it
///           is the cost of a step
/// @param t  time at the start of the step [s]
/// @param y  state at t, (n), n >= 1
/// @param h  length of the step [s]; may be negative (backwards in time) or 0
/// @return the state at t + h, (n)
/// Source: Hairer, I.7.   Tests: EulerStep.*, LectureExample.*
/// Hints: handouts/a2_integration.md#hint-euler
VectorXd euler_step(const OdeFunction& f, double t, const VectorXd& y, double h);

/// One step of the classical Runge-Kutta method: four slopes, weighted as in Simpson's rule.
///   k1 = f(t, y)                      k2 = f(t + h/2, y + (h/2) k1)
///   k3 = f(t + h/2, y + (h/2) k2)     k4 = f(t + h, y + h k3)
///   y(t + h) ~ y + (h/6) (k1 + 2 k2 + 2 k3 + k4)                                            (A2.2)
/// Order 4: halving h divides the error by 16. Exact for f = f(t) a polynomial of degree 3 or less.
/// It does not conserve energy; the drift per unit of time shrinks with h^4 (of an undamped linear
/// oscillation with h^5).
/// @param f  called exactly four times, in the order k1, k2, k3, k4
/// @param t, y, h  as for euler_step
/// @return the state at t + h, (n)
/// Source: Hairer, II.1 (Kutta 1901).   Tests: Rk4Step.*, LectureExample.*
/// Hints: handouts/a2_integration.md#hint-rk4
VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h);

// ---- A rigid body as y --------------------------------------------------------------------------

/// Inertia tensor of a turned body in the world frame.
///   I_world = R I_body R^T                                                                  (A2.3)
/// @param inertia_body     I_body, (3,3), symmetric, body frame, about the centre of mass [kg m^2]
/// @param world_from_body  q, unit; R is its rotation matrix
/// @return I_world, (3,3), world frame, about the centre of mass [kg m^2]
/// @post  symmetric to round-off; principal moments are those of I_body.  The same formula serves
///        an inverse inertia.
/// Source: Baraff, section 2.10.   Tests: InertiaInWorld.*
/// Hints: handouts/a2_integration.md#hint-inertia
Matrix3d inertia_in_world(const Matrix3d& inertia_body, const Quaterniond& world_from_body);

/// Time derivative of a rigid body's state under a force and a torque: the f of (A2.2).
///   x' = P / m,   q' = 1/2 (0, w_world) q,   P' = F,   L' = tau                             (A2.4)
///   w_world = R ( I_body^-1 ( R^T L ) )                                                     (A2.5)
/// (0, w) q is a Hamilton product with the angular velocity, in the world frame, on the left.
/// (A2.5) goes through the body frame on purpose: with a world inverse inertia R I_body^-1 R^T a
/// needle (moments 1e-6 : 1) loses six digits of its rotation end over end.
/// @param state    x: com_world [m];  q: world_from_body, as near to unit as an integrator keeps it
///                 (for a body without links the engine passes unit length at every stage of a
///                 method: R of a longer q is no rotation);
///                 P: momentum_world [kg m/s];  L: angular_momentum_world, about the centre of mass
///                 [kg m^2/s]
/// @param inertia  1/m: inverse_mass [1/kg];  I_body^-1: inverse_inertia_body [1/(kg m^2)]
/// @param wrench   F: force_world [N];  tau: torque_world, about the centre of mass [N m]
/// @return (13), in the layout of pack() in framework/dynamics/ode.h: x' [m/s] (3), q' as w x y z
///         [1/s] (4), P' [N] (3), L' [N m] (3)
/// @post  q . q' == 0 to round-off: turning does not change the length of q
/// Source: Baraff, sections 2.8-2.11, section 4 and appendix B.   Tests: RigidBodyDerivative.*
/// Hints: handouts/a2_integration.md#hint-derivative
VectorXd rigid_body_derivative(const RigidBodyState& state, const Inertia& inertia,
                               const Wrench& wrench);

// ---- Orientations that have drifted, and angles -------------------------------------------------

/// A quaternion of unit length in the same direction of R^4.
///   q / |q|                                                                                 (A2.6)
/// @param world_from_body  q, not zero, any length
/// @return unit to round-off, not negated: q and -q are one rotation, but a jump between them would
///         spoil interpolation
/// Source: Baraff, section 4.   Tests: Renormalize.*
/// Hints: handouts/a2_integration.md#hint-renormalize
Quaterniond renormalize(const Quaterniond& world_from_body);

/// The rotation that Gram-Schmidt makes from a drifted rotation matrix, column by column from the
/// left.
///   x = a / |a|,   y = b - (x . b) x,  y = y / |y|,
///       z = c - (x . c) x - (y . c) y,  z = z / |z|                                         (A2.7)
/// with a, b, c the columns of the argument and x, y, z those of the result. For a right-handed
/// argument z equals x cross y.
/// @param drifted_world_from_body  (3,3), columns independent and right-handed (determinant > 0)
/// @return (3,3): R^T R == 1 to round-off, determinant +1. x keeps the direction of a; y stays in
///         the plane of a and b
/// Source: Golub, section 5.2.7; Baraff, section 4.   Tests: Orthonormalize.*
/// Hints: handouts/a2_integration.md#hint-gram-schmidt
Matrix3d orthonormalize(const Matrix3d& drifted_world_from_body);

/// Angles of three turns, each about an axis that the earlier turns have moved: z, then y', then
/// x''.
struct EulerAngles {
  double yaw = kUnset;    // about z [rad]
  double pitch = kUnset;  // about y' [rad]
  double roll = kUnset;   // about x'' [rad]
};

/// Rotation matrix of Euler angles, z-y'-x'' intrinsic (the same as x-y-z about axes fixed in the
/// world).
///   R = R_z(yaw) R_y(pitch) R_x(roll)                                                       (A2.8)
///   R_z(a) = (cos a, -sin a, 0; sin a, cos a, 0; 0, 0, 1), and R_y, R_x by cyclic exchange of the
///   axes
/// @param yaw, pitch, roll  any angles [rad]
/// @return (3,3), body to world.   A positive pitch turns the nose (body x) down: R e_x has z =
///         -sin(pitch).
/// Source: Diebel, sequence (1,2,3), transposed.   Tests: EulerAngles.*
/// Hints: handouts/a2_integration.md#hint-euler-angles
Matrix3d rotation_from_euler_angles(double yaw, double pitch, double roll);

/// Euler angles of a rotation matrix: the way back from (A2.8).
///   c = sqrt(R_00^2 + R_10^2),   pitch = atan2(-R_20, c),   yaw = atan2(R_10, R_00),
///       roll = atan2(R_21, R_22)
///   gimbal lock, c < 1e-8:       roll = 0,                  yaw = atan2(-R_01, R_11)        (A2.9)
/// In gimbal lock (pitch = +-90 degrees) yaw and roll turn about the same line: only their sum or
/// difference is defined. The convention roll = 0 picks one pair and keeps the rotation.
/// @param world_from_body  R, (3,3), a rotation; R_ij counts rows and columns from 0
/// @return yaw and roll in [-pi, pi], pitch in [-pi/2, pi/2] [rad]; never NaN, also where rounding
///         made |R_20| exceed 1
/// @post  rotation_from_euler_angles gives R back to 1e-7 for every rotation, to 1e-12 where c >
///        1e-3
/// Source: Diebel, section 5.6.   Tests: EulerAngles.*
/// Hints: handouts/a2_integration.md#hint-gimbal-lock
EulerAngles euler_angles_from_rotation(const Matrix3d& world_from_body);

// ---- Time of impact -----------------------------------------------------------------------------
//
// Both functions find a time at which a gap g(t) closes, between a time when it is open and one
// when it is not:
//   g(t_low) >= 0   and   g(t_high) <= 0                                                    (A2.10)
// and keep a bracket [a, b] with g(a) >= 0 and g(b) <= 0, which only shrinks. Both return:
//   kConverged     time = a, the end where the gap has not closed: g(time) >= 0, so that nothing
//                  penetrates there. b - a <= tolerance, or no double lies between a and b, or
//                  g(time) == 0 exactly
//   kNoSignChange  both ends open, g > 0 (no impact seen), or g(t_low) < 0 (overlap from the
//                  start). time and residual are NaN; nothing but the two ends was evaluated
//   kNotConverged  the search ended with a larger bracket; here the only cause is a g that gave NaN
//                  (there is no limit of iterations). time and residual are those of the last a
//                  (t_low, where g(t_high) is NaN), or NaN where g(t_low) is NaN
// residual is g(time); evaluations counts the calls of g. An end that is exactly 0 is an impact,
// unless g(t_low) < 0: t_low is tested first; g(t_low) == 0 is one also where the gap opens
// afterwards, g(t_high) > 0. An even number of crossings inside the interval cannot be seen from
// its ends: the caller chooses the interval.

/// Time of impact by bisection: halve the bracket, keep the half where the sign changes.
///   m = a + (b - a) / 2;   g(m) >= 0: a = m,  otherwise b = m;   until b - a <= tolerance  (A2.11)
/// @param gap         g [m], continuous; may be costly: it is the cost of the search
/// @param t_low       [s], t_low < t_high
/// @param t_high      [s]
/// @param tolerance   >= 0 [s]; 0: down to the last bracket that doubles can represent
/// @return see above; evaluations <= 4 + log2((t_high - t_low) / tolerance)
/// Source: NR, section 9.1.   Tests: ImpactTimeBisection.*
/// Hints: handouts/a2_integration.md#hint-bisection
RootResult impact_time_bisection(const ScalarFunction& gap, double t_low, double t_high,
                                 double tolerance);

/// Time of impact by Newton-Raphson, with bisection as its safeguard.
///   t_next = t - g(t) / g'(t)          from the last t                                     (A2.12)
/// A midpoint is taken instead where t_next is no number (slope 0), is not inside (a, b), or where
/// the bracket or the steps shrink too slowly (cycling, multiple roots). Newton approaches a root
/// from one side: step slightly past it, so that the bracket closes from the other side too.
/// @param gap_rate    g' [m/s]; may be 0, or wrong by rounding, or infinite: the answer is right
///                    all the same, only later
/// @param gap, t_low, t_high, tolerance  as for bisection
/// @return see above; evaluations: on average at most 30 over parabolas with a tolerance of 1e-12
///         of the interval, where bisection takes 44, and never more than 10 + 4 times those of
///         bisection, whatever the gap
/// Source: NR, section 9.4.   Tests: ImpactTimeNewton.*
/// Hints: handouts/a2_integration.md#hint-newton
RootResult impact_time_newton(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                              double t_low, double t_high, double tolerance);

}  // namespace tumble::a2

TUMBLE_MODULE(a2, euler_step, rk4_step, inertia_in_world, rigid_body_derivative, renormalize,
              orthonormalize, rotation_from_euler_angles, euler_angles_from_rotation,
              impact_time_bisection, impact_time_newton);

#ifndef TUMBLE_BUILDING_MODULE  // for callers
namespace tumble::a2 {

/// How many numbers each answer has: checked on what your functions return, before its use.
inline void describe(modules::AnswerSizes<Module>& sizes) {
  sizes.add(&Module::euler_step,
            [](const OdeFunction&, double, const VectorXd& y, double) { return y.size(); });
  sizes.add(&Module::rk4_step,
            [](const OdeFunction&, double, const VectorXd& y, double) { return y.size(); });
  sizes.add(&Module::rigid_body_derivative,
            [](const RigidBodyState&, const Inertia&, const Wrench&) { return kStateSize; });
}

}  // namespace tumble::a2
#endif
