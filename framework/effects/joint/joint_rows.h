/// The rows of joints: ball joints, hinges and welds, made of the same rows as a student's rods.
///
/// A ball joint keeps a point of A on a point of B: three rows along the world's axes. A hinge
/// keeps two axes of A across the hinge's axis of B besides; a weld a third pair.
///   point:   C = e . (p_a - p_b),    J_a = (e, r_a x e),        J_b = -(e, r_b x e)          (J.1)
///            J' u = e . (w_a x (w_a x r_a) - w_b x (w_b x r_b))
///   axes:    C = x_a . z_b,          J_a = (0, x_a x z_b),      J_b = -J_a                   (J.2)
///            J' u = ((w_a x x_a) x z_b + x_a x (w_b x z_b)) . (w_a - w_b)
/// World frame throughout; r is from the centre of mass to the point. Source: M. Cline, "Rigid body
/// simulation with contact and constraints", UBC 2002, chapter 4.
#pragma once

#include <vector>

#include "framework/dynamics/constraint.h"
#include "framework/effects/joint/joint.h"

namespace tumble::effects {

/// How many rows a joint has: 3, 5 or 6.
int row_count(JointKind kind);

/// Appends the rows of a joint where its bodies are now. For the world's end pass a body at the
/// origin that does not move.
/// @param index_a, index_b  what Constraint::body_a and body_b shall say
void append_joint_rows(const JointLink& joint, const Body& a, int index_a, const Body& b,
                       int index_b, std::vector<Constraint>& rows);

/// Angle of B against A about a hinge's axis, and its rate. [rad], [rad/s]; the angle is in (-pi,
/// pi], 0 at the start.
struct HingeMotion {
  double angle, rate;
  Vector3d axis_world;
};
HingeMotion hinge_motion(const JointLink& joint, const Body& a, const Body& b);

}  // namespace tumble::effects
