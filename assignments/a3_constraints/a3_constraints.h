/// Assignment 3, Constraints: what you write. Theory, hints and points: handouts/a3_constraints.md.
/// Your file: a3_constraints.cpp.
///
/// What holds bodies together and what holds them apart: springs between two anchors; rods, which
/// are infinitely stiff springs with constraint forces to solve for; stabilisation, because a
/// simulated rod drifts; and resting contact, where forces push, never pull.
///
/// Terms, symbols and sources: handouts/notation.md.
/// Frames: `world` is inertial, right-handed, z up; `body` has its origin at the centre of mass and
/// turns with the body. Six numbers of a body are (linear, angular), world frame: velocity u = (v,
/// omega), force (F, tau about the centre of mass). Units SI. A body of infinite mass (the ceiling,
/// the floor) has inverse mass 0 and zero inverse inertia: use these two and every formula below
/// holds for it; it may be driven (a lift: then its free_acceleration is the drive's), but no
/// force moves it.
/// Types: framework/dynamics/constraint.h and body.h.
/// Sources, cited below by name:
///   Witkin    A. Witkin, "Constrained dynamics", SIGGRAPH course notes, 1997
///   Baraff96  D. Baraff, "Linear-time dynamics using Lagrange multipliers", SIGGRAPH 1996
///   Baraff94  D. Baraff, "Fast contact force computation for nonpenetrating rigid bodies",
///             SIGGRAPH 1994
///   Baumgarte J. Baumgarte, "Stabilization of constraints and integrals of motion", Comput.
///             Methods Appl. Mech. Eng. 1, 1972
///   Cottle    R. Cottle, J.-S. Pang, R. Stone, "The Linear Complementarity Problem", 1992
#pragma once

#include <vector>

#include "framework/core/not_implemented.h"
#include "framework/dynamics/body.h"
#include "framework/dynamics/constraint.h"
#include "framework/modules/answer_sizes.h"
#include "framework/modules/module.h"

namespace tumble::a3 {

// ---- Anchors and springs ------------------------------------------------------------------------

/// Position of an anchor, a point fixed in a body.
///   p = x + R p_body                                                                        (A3.1)
/// @param body        x: com_world [m];  R: world_from_body
/// @param point_body  p_body, (3), body frame, from the centre of mass [m]
/// @return p, (3), world frame [m]
/// Source: Baraff, "Rigid body simulation" I, SIGGRAPH course notes 1997, eq. 2-1.
/// Tests: AnchorPosition.*
/// Hints: handouts/a3_constraints.md#hint-anchors
Vector3d anchor_position(const Body& body, const Vector3d& point_body);

/// Velocity of an anchor.
///   p' = v + omega x r,   r = R p_body                                                      (A3.2)
/// @param body        v: velocity_world [m/s];  omega: omega_world [rad/s]
/// @param point_body  as above
/// @return p', (3), world frame [m/s]
/// Source: the same, section 2.5.   Tests: AnchorVelocity.*
/// Hints: handouts/a3_constraints.md#hint-anchors
Vector3d anchor_velocity(const Body& body, const Vector3d& point_body);

/// Force of a damped spring on the body at its end A; the body at B feels the opposite.
///   F = ( k (|d| - L0) + c n . (v_b - v_a) ) n,   d = p_b - p_a,   n = d / |d|              (A3.3)
/// A stretched spring pulls A towards B. The damper acts along the spring only: motion round the
/// other end is not damped.
/// @param spring  k: stiffness [N/m];  c: damping [N s/m];  L0: rest_length [m]; all >= 0
/// @param a, b    p: point_world [m];  v: velocity_world [m/s]
/// @return F on A, (3), world frame [N]; exactly 0 where the anchors coincide (p_a == p_b): there
///         is no direction
/// @post  finite, and right to round-off, for every length from 1e-200 to 1e+200 m, where a plain
///        |d|^2 underflows or overflows.  For L0 = 0 and c = 0 F = k d
/// Source: Witkin, "Particle system dynamics", SIGGRAPH course notes 1997, eq. 2.
/// Tests: SpringForce.*
/// Hints: handouts/a3_constraints.md#hint-spring
Vector3d spring_force(const Spring& spring, const AnchorState& a, const AnchorState& b);

// ---- Rods ---------------------------------------------------------------------------------------

/// A rod without mass between a point of A and a point of B, as an equation C = 0 and its
/// derivatives.
///   C = |d| - length,   d = p_a - p_b,   n = d / |d|
///   C' = n . d',   J_a = (n, r_a x n),   J_b = (-n, -(r_b x n)),   r = R p_body             (A3.4)
///   J' u = n . ( w_a x (w_a x r_a) - w_b x (w_b x r_b) ) + ( |d'|^2 - (n . d')^2 ) / |d|    (A3.5)
/// (A3.5) is C'' of bodies that do not accelerate: points of turning bodies do (centripetally), and
/// the end of a swinging rod must leave its straight path. A multiplier lambda > 0 pushes the ends
/// apart; a rod that carries a weight has lambda < 0.
/// @param a, b                        position and velocity; inertia is not needed
/// @param point_a_body, point_b_body  (3), each in the frame of its body, from its centre of mass
///     [m]
/// @param length                      > 0 [m]
/// @return value: C [m];  rate: C' [m/s];  jacobian_a, jacobian_b: J [-, m];  velocity_product: J'
///         u [m/s^2]. Where the points coincide there is no direction: J = 0, C' = 0, J' u = 0, and
///         C = -length
/// @post  C' == J_a . u_a + J_b . u_b to round-off
/// Source: Witkin, sections 2-4; Baraff96, section 2.   Tests: RodRow.*
/// Hints: handouts/a3_constraints.md#hint-rod
ConstraintRow rod_row(const Body& a, const Vector3d& point_a_body, const Body& b,
                      const Vector3d& point_b_body, double length);

/// The C'' that returns a drifting constraint like a critically damped spring, without overshoot.
///   C'' = -(2 / T) C' - C / T^2                                                             (A3.6)
/// Then C(t) = (C0 + (C0' + C0 / T) t) exp(-t / T). It is not physical: a short T stabilises better
/// and puts more of the error into the motion; T far below the integrator's step h is unstable
/// (below h/2 for Euler, below 0.36 h for RK4).
/// @param value            C [m]
/// @param rate             C' [m/s]
/// @param time_constant_s  T > 0 [s]
/// @return C'' [m/s^2]
/// Source: Baumgarte.   Tests: Baumgarte.*   Hints: handouts/a3_constraints.md#hint-baumgarte
double baumgarte_acceleration(double value, double rate, double time_constant_s);

/// The multipliers at which every constraint has its wanted acceleration.
///   A lambda = C''_wanted - ( J u'_free + J' u ),   A = J M^-1 J^T                          (A3.7)
/// where u' = u'_free + M^-1 J^T lambda. Row i of J holds jacobian_a in the six columns of body_a
/// and jacobian_b in those of body_b; M^-1 is made of blocks (inverse_mass 1,
/// inverse_inertia_world). A, the inverse effective mass, has A_ij = 0 where rows i and j share no
/// movable body: a chain's A has three numbers a row, and a sparse solve costs O(links).
/// @param rows                 m constraints; a body may be in any number of them
/// @param bodies               n bodies, some of them of infinite mass
/// @param wanted_acceleration  C''_wanted, (m) [m/s^2]: 0, or Baumgarte's
/// @return lambda, (m) [N]; a row that moves nothing (both bodies of infinite mass, or J = 0) has
///         lambda 0
/// @post  C'' is C''_wanted, to round-off. Redundant rows (a rod twice) share its force in any way:
///        the sum of J^T lambda is right. Contradictory rows cannot all hold: lambda is some finite
///        answer. Never NaN.
/// Cost: 1,000 rods in a chain within a tenth of a second. Right to 1e-8 of the largest where one
/// mass is 1e6 times the others, in chains of up to 100; to 1e-6 where such masses alternate.
/// Source: Witkin, section 3; Baraff96, sections 3 and 7.   Tests: ConstraintMultipliers.*
/// Hints: handouts/a3_constraints.md#hint-multipliers
VectorXd constraint_multipliers(const std::vector<Constraint>& rows,
                                const std::vector<ConstrainedBody>& bodies,
                                const VectorXd& wanted_acceleration);

/// The change, minimal in the kinetic (mass) metric, that removes an error from every constraint:
/// stabilisation by projection.
///   x = -M^-1 J^T lambda,   A lambda = error,   hence  J x = -error                         (A3.8)
/// With error = C it corrects positions (in linearised steps: call it again after moving); with
/// error = C' velocities. Of all x with J x = -error it has the least x . M x, so it adds no
/// momentum of its own.
/// @param rows, bodies  as above; free_acceleration and velocity_product are not needed
/// @param error         C or C', (m)
/// @return x, (6n): for each body in turn (linear, angular), world frame [m, rad, or per second]; 0
///         for infinite mass
/// @post  redundant and singular rows as above
/// Source: M. Cline, D. Pai, "Post-stabilization for rigid body simulation with contact and
/// constraints", ICRA 2003.
/// Tests: ConstraintCorrection.*   Hints: handouts/a3_constraints.md#hint-correction
VectorXd constraint_correction(const std::vector<Constraint>& rows,
                               const std::vector<ConstrainedBody>& bodies, const VectorXd& error);

// ---- Resting contact ----------------------------------------------------------------------------

/// Forces of resting contacts without friction: they push only, and only where the bodies do not
/// separate.
///   f >= 0,   a = A f + b >= 0,   f . a = 0                                                 (A3.9)
/// @param A  (m,m), m >= 1, symmetric, positive SEMI-definite: how contact j's force accelerates
///           contact i apart [1/kg]. Singular as soon as contacts are redundant (a table on four
///           legs)
/// @param b  (m): acceleration apart without contact forces [m/s^2]; < 0: the bodies would
///           penetrate. Where a gap is left that may still close, b is larger by what it allows:
///           contacts that are redundant in A may differ in b
/// @pre   some f solves (A3.9); it does for every A = J M^-1 J^T with b = J u' or anything larger,
///        where u' is any acceleration in which bodies of infinite mass rest
/// @return f, (m) [N]. It need not be unique; a = A f + b is, to 1e-10 of the largest |b|. A
///         contact with A_ii = 0 (nothing there can move) has f_i = 0, whatever its b
/// Source: Baraff94, sections 2-4; Cottle, chapters 3 and 4.   Tests: ContactForces.*
/// Hints: handouts/a3_constraints.md#hint-contact
VectorXd contact_forces(const MatrixXd& A, const VectorXd& b);

/// Whether a collision begins a resting contact: its bounce would be slower than the restitution
/// threshold (rest_speed).
///   e |u_n| <= rest speed                                                                  (A3.10)
/// Without it a ball bounces infinitely often in finite time.
/// @param approach_speed  |u_n| >= 0, with which the bodies meet [m/s]
/// @param restitution     e, 0 to 1
/// @param rest_speed      >= 0 [m/s]
/// @return true where the speed after the bounce, e |u_n|, does not exceed rest_speed
/// Source: Baraff, "Rigid body simulation" II, SIGGRAPH course notes 1997, section 8.
/// Tests: EndsInContact.*   Hints: handouts/a3_constraints.md#hint-rest
bool ends_in_contact(double approach_speed, double restitution, double rest_speed);

}  // namespace tumble::a3

TUMBLE_MODULE(a3, anchor_position, anchor_velocity, spring_force, rod_row, baumgarte_acceleration,
              constraint_multipliers, constraint_correction, contact_forces, ends_in_contact);

#ifndef TUMBLE_BUILDING_MODULE  // for callers
namespace tumble::a3 {

/// How many numbers each answer has: checked on what your functions return, before its use.
inline void describe(modules::AnswerSizes<Module>& sizes) {
  using Rows = std::vector<Constraint>;
  using Bodies = std::vector<ConstrainedBody>;
  sizes.add(&Module::constraint_multipliers, [](const Rows& rows, const Bodies&, const VectorXd&) {
    return static_cast<Eigen::Index>(rows.size());
  });
  sizes.add(&Module::constraint_correction, [](const Rows&, const Bodies& bodies, const VectorXd&) {
    return 6 * static_cast<Eigen::Index>(bodies.size());
  });
  sizes.add(&Module::contact_forces, [](const MatrixXd&, const VectorXd& b) { return b.size(); });
}

}  // namespace tumble::a3
#endif
