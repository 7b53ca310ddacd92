/// Assignment 1, Impulse: what you write. Theory, hints and points: handouts/a1_impulse.md. Your
/// file: a1_impulse.cpp.
///
/// From a mouse click to a moving body: a ray finds the triangle under the pixel, a force at that
/// point becomes force and torque, and these become accelerations. From contact to bounce: the
/// contact normal and the relative velocity say whether two bodies collide, an impulse changes
/// their velocities at once.
///
/// Terms, symbols and sources: handouts/notation.md.
/// Frames: `world` is inertial, right-handed, z up; `body` has its origin at the centre of mass and
/// turns with the body. Every vector's name ends in its frame. Units SI. A body of infinite mass (a
/// wall) has inverse_mass 0 and a zero inverse_inertia_body: use these two and every formula below
/// holds for it without a special case. Do not use its mass (+infinity) or its inertia_body.
/// Sources, cited below by name:
///   Hecker   C. Hecker, "Physics" parts 1-4, Game Developer, Oct 1996 - Jun 1997 (part 3:
///            collision response)
///   Baraff   D. Baraff, "Rigid body simulation" I and II, SIGGRAPH course notes, 1997
///   Moeller  T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", J.
///            Graphics Tools 2(1), 1997
///   Woop     S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013
#pragma once

#include <optional>

#include "framework/core/not_implemented.h"
#include "framework/dynamics/body.h"
#include "framework/modules/module.h"

namespace tumble::a1 {

// ---- From a click to a force --------------------------------------------------------------------

/// Where a ray meets a closed triangle, if it does.
///   o + t d = w_a a + w_b b + w_c c,   w_a + w_b + w_c = 1,
///       hit when w_a, w_b, w_c >= 0 and t >= 0                                              (A1.1)
/// Both faces count. A point on an edge or a corner is a hit (weights of exactly 0 and 1 are
/// inside), so that a ray through the seam of two triangles hits at least one of them (which of
/// them, rounding may decide). A ray parallel to the plane, also one inside it, is a miss.
/// @param ray       o, d: (3), world; o [m]; d not zero and of any length: t counts in lengths of d
/// @param triangle  a, b, c: (3), world [m], either orientation, of any size: a micrometre is not
///                  "almost zero"
/// @return t [-] and the barycentric weights (w_a, w_b, w_c) [-]; nothing for a miss, a triangle
///         behind o, or a parallel ray
/// @post   o + t d and w_a a + w_b b + w_c c are the same point to round-off
/// Source: Moeller; watertight signs at a seam: Woop.   Tests: RayTriangle.*
/// Hints: handouts/a1_impulse.md#hint-ray
std::optional<RayHit> intersect_ray_triangle(const Ray& ray, const Triangle& triangle);

/// The wrench of a force at a point: the same force on the centre of mass, and a torque about it.
///   r = p - x,   tau = r x F                                                                (A1.2)
/// @param force_world  F, (3), world [N]
/// @param point_world  p, (3), world: where it acts [m]
/// @param com_world    x, (3), world: centre of mass [m]
/// @return F (3), world [N] and tau (3), world, about the centre of mass [N m]
/// Source: Baraff I, section 2.7; Hecker part 2.   Tests: PointForce.*
/// Hints: handouts/a1_impulse.md#hint-wrench
Wrench wrench_of_point_force(const Vector3d& force_world, const Vector3d& point_world,
                             const Vector3d& com_world);

/// Acceleration of the centre of mass.
///   a = F / m                                                                               (A1.3)
/// @param force_world  F, (3), world: sum of all forces [N]
/// @return a, (3), world [m/s^2]; exactly zero for infinite mass
/// Source: Baraff I, section 2.8.   Tests: LinearAcceleration.*
/// Hints: handouts/a1_impulse.md#hint-linear
Vector3d linear_acceleration(const Body& body, const Vector3d& force_world);

/// Time derivative of a body's angular velocity: Newton-Euler, with the gyroscopic term.
///   I alpha = tau - w x (I w)   in the body frame, where I is constant                      (A1.4)
///   w_body = R^T w_world,   tau_body = R^T tau_world,   alpha_world = R alpha_body
/// @param body          I: inertia_body (3,3), about the centre of mass [kg m^2]; R:
///                      world_from_body; w: omega_world [rad/s]
/// @param torque_world  tau, (3), world, about the centre of mass [N m]
/// @return alpha, (3), world [rad/s^2]; exactly zero for infinite mass; not zero for a free body
///         that tumbles
/// Source: Baraff I, sections 2.9 and 2.10; Goldstein, Classical Mechanics, section 5.5.
/// Tests: AngularAcceleration.*   Hints: handouts/a1_impulse.md#hint-angular
Vector3d angular_acceleration(const Body& body, const Vector3d& torque_world);

// ---- Do they collide? ---------------------------------------------------------------------------

/// How fast the gap between two bodies grows at their contact.
///   u_n = n . (u_a - u_b),   u = v + w x r,   r = p - x                                     (A1.5)
/// @param contact  p: point_world (3) [m];  n: normal_b_to_a_world (3), unit, from B to A [-]
/// @param a, b     v: velocity_world [m/s], w: omega_world [rad/s], x: com_world [m]; an immovable
///                 body may move
/// @return u_n [m/s]; negative: approaching, positive: separating
/// Source: Hecker part 3; Baraff II, eq. 8-1 to 8-3.   Tests: RelativeNormalVelocity.*
/// Hints: handouts/a1_impulse.md#hint-relative
double relative_normal_velocity(const Contact& contact, const Body& a, const Body& b);

enum class RelativeMotion { kApproaching, kResting, kSeparating };

/// The case that a relative normal velocity belongs to.
///   approaching  u_n < -tolerance;   resting  |u_n| <= tolerance;
///       separating  u_n > tolerance                                                         (A1.6)
/// @param normal_velocity  u_n [m/s]
/// @param tolerance        >= 0 [m/s]; a value exactly at it is resting
/// Source: Baraff II, section 8.   Tests: RelativeMotionCases.*
/// Hints: handouts/a1_impulse.md#hint-cases
RelativeMotion classify_relative_motion(double normal_velocity, double tolerance);

// ---- Contact normals of polygons in the plane: all unit, all from B to A ------------------------

/// A corner of A on an edge of B: the edge's perpendicular, on the side of the corner.      (A1.7a)
/// @param vertex_a_world                        (2), world [m]
/// @param edge_start_b_world, edge_end_b_world  (2), world [m], distinct
/// @return n, (2), unit, from B to A [-]. A corner exactly on the edge's line has no side: then the
///         right-hand side of start -> end, which is outside when B is listed counter-clockwise.
///         (Within rounding of the line either side is right.)
/// Source: Hecker part 3.   Tests: ContactNormal2d.*   Hints: handouts/a1_impulse.md#hint-normals
Vector2d contact_normal_vertex_edge(const Vector2d& vertex_a_world,
                                    const Vector2d& edge_start_b_world,
                                    const Vector2d& edge_end_b_world);

/// An edge of A flat on an edge of B: B's perpendicular, on the side of A's centre.         (A1.7b)
/// @param edge_start_b_world, edge_end_b_world  (2), world [m], distinct, in either order
/// @param com_a_world                           (2), world [m], not on the edge's line
/// @return n, (2), unit, from B to A [-]
/// Source: Hecker part 3.   Tests: ContactNormal2d.*   Hints: handouts/a1_impulse.md#hint-normals
Vector2d contact_normal_edge_edge(const Vector2d& edge_start_b_world,
                                  const Vector2d& edge_end_b_world, const Vector2d& com_a_world);

/// A corner of A on a corner of B: geometry gives no normal; by convention it is the line of the
/// centres.
///   n = (x_a - x_b) / |x_a - x_b|                                                          (A1.7c)
/// @param com_a_world, com_b_world  (2), world [m], distinct
/// @return n, (2), unit, from B to A [-]
/// Tests: ContactNormal2d.*   Hints: handouts/a1_impulse.md#hint-normals
Vector2d contact_normal_vertex_vertex(const Vector2d& com_a_world, const Vector2d& com_b_world);

// ---- Collision response -------------------------------------------------------------------------

/// Size of the impulse between two bodies that collide without turning, as point masses do.
///   j = -(1 + e) n . (v_a - v_b) / (1/m_a + 1/m_b)                                          (A1.8)
/// Angular velocities and inertia tensors are ignored.
/// @param contact      n: unit, (3), world, from B to A [-]; the point is ignored
/// @param restitution  e in [0, 1]: 0 perfectly inelastic, 1 elastic
/// @return j >= 0 [N s]; exactly 0 when the bodies do not approach (n . (v_a - v_b) >= 0) or both
///         are of infinite mass
/// Source: Hecker part 3.   Tests: ImpulseWithoutRotation.*
/// Hints: handouts/a1_impulse.md#hint-impulse
double collision_impulse_without_rotation(const Contact& contact, const Body& a, const Body& b,
                                          double restitution);

/// Size of the impulse between two bodies that collide at one point without friction.
///   j = -(1 + e) u_n / (1/m_a + 1/m_b + n . [ (I_a^-1 (r_a x n)) x r_a
///       + (I_b^-1 (r_b x n)) x r_b ])                                                       (A1.9)
/// with the inverse inertia in the WORLD frame:  I^-1 = R I_body^-1 R^T.
/// @param contact      n: unit, (3), world, from B to A [-];  p: point_world (3) [m]
/// @param a, b         r = p - x;  a body of infinite mass has inverse mass 0 and zero inverse
///                     inertia
/// @param restitution  e in [0, 1]
/// @return j >= 0 [N s]; exactly 0 when the bodies do not approach (u_n >= 0) or both are of
///         infinite mass
/// @post   applied as +j n to A and -j n to B:  u_n after == -e u_n before, to round-off
/// Source: Hecker part 3, eq. 9; Baraff II, eq. 8-18.   Tests: CollisionImpulse.*
/// Hints: handouts/a1_impulse.md#hint-impulse
double collision_impulse(const Contact& contact, const Body& a, const Body& b, double restitution);

/// Velocities of one body just after an impulse at a point of it.
///   v' = v + J / m,   w' = w + I^-1 (r x J),   r = p - x,   I^-1 in the world frame        (A1.10)
/// @param impulse_world  J, (3), world [N s]: a vector, already with the sign that is right for
///                       this body
/// @param point_world    p, (3), world [m]
/// @return v', w' (3), world; bit for bit the old ones for a body of infinite mass
/// Source: Hecker part 3, eq. 8; Baraff II, section 8.   Tests: ApplyImpulse.*
/// Hints: handouts/a1_impulse.md#hint-apply
Velocity apply_impulse(const Body& body, const Vector3d& impulse_world,
                       const Vector3d& point_world);

/// Velocities of two bodies just after a collision.
struct CollisionOutcome {
  Velocity a;
  Velocity b;
};

/// The whole collision response: the impulse (A1.9), on A along the normal and on B against it.
///   J_a = +j n,   J_b = -j n      (action = reaction)                                      (A1.11)
/// @return velocities after; the old ones when the bodies do not approach
/// @post   momentum and angular momentum of the pair are unchanged to round-off when both are
///         movable; kinetic energy is unchanged for e = 1 and never grows, unless an immovable body
///         moves (a wall at V throws a ball at 2 V)
/// Source: Baraff II, section 8.   Tests: ResolveCollision.*
/// Hints: handouts/a1_impulse.md#hint-resolve
CollisionOutcome resolve_collision(const Contact& contact, const Body& a, const Body& b,
                                   double restitution);

}  // namespace tumble::a1

TUMBLE_MODULE(a1, intersect_ray_triangle, wrench_of_point_force, linear_acceleration,
              angular_acceleration, relative_normal_velocity, classify_relative_motion,
              contact_normal_vertex_edge, contact_normal_edge_edge, contact_normal_vertex_vertex,
              collision_impulse_without_rotation, collision_impulse, apply_impulse,
              resolve_collision);
