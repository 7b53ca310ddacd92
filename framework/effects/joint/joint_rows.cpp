#include "framework/effects/joint/joint_rows.h"

#include <cmath>

namespace tumble::effects {
namespace {

// What the three rows of a point share: how B's point moves against A's, and what it accelerates by
// turning.
struct PointMotion {
  Vector3d apart, velocity, centripetal;
};

PointMotion point_motion(const Body& a, const Vector3d& r_a, const Body& b, const Vector3d& r_b) {
  const Vector3d turning_a = a.omega_world.cross(r_a), turning_b = b.omega_world.cross(r_b);
  // The difference of the centres first: far from the origin the small arms keep their digits.
  return {(a.com_world - b.com_world) + r_a - r_b,
          (a.velocity_world - b.velocity_world) + turning_a - turning_b,
          a.omega_world.cross(turning_a) - b.omega_world.cross(turning_b)};
}

Constraint& append_row(int index_a, int index_b, std::vector<Constraint>& rows) {
  Constraint& constraint = rows.emplace_back();
  constraint.body_a = index_a;
  constraint.body_b = index_b;
  return constraint;
}

void append_point_rows(const PointMotion& motion, const Vector3d& r_a, const Vector3d& r_b,
                       int index_a, int index_b, std::vector<Constraint>& rows) {
  for (int axis = 0; axis < 3; ++axis) {
    Constraint& constraint = append_row(index_a, index_b, rows);
    const Vector3d e = Vector3d::Unit(axis);
    constraint.row.jacobian_a.head<3>() = e;
    constraint.row.jacobian_a.tail<3>() = r_a.cross(e);
    constraint.row.jacobian_b.head<3>() = -e;
    constraint.row.jacobian_b.tail<3>() = e.cross(r_b);
    constraint.row.value = motion.apart[axis];
    constraint.row.rate = motion.velocity[axis];
    constraint.row.velocity_product = motion.centripetal[axis];
  }
}

/// x_a of A and z_b of B stay at right angles.
void append_axes_row(const Vector3d& x_a, const Body& a, int index_a, const Vector3d& z_b,
                     const Body& b, int index_b, std::vector<Constraint>& rows) {
  const Vector3d across = x_a.cross(z_b), turning = a.omega_world - b.omega_world;
  ConstraintRow& row = append_row(index_a, index_b, rows).row;
  row.jacobian_a.head<3>().setZero();
  row.jacobian_a.tail<3>() = across;
  row.jacobian_b.head<3>().setZero();
  row.jacobian_b.tail<3>() = -across;
  row.value = x_a.dot(z_b);
  row.rate = across.dot(turning);
  row.velocity_product =
      (a.omega_world.cross(x_a).cross(z_b) + x_a.cross(b.omega_world.cross(z_b))).dot(turning);
}

}  // namespace

int row_count(JointKind kind) {
  switch (kind) {
    case JointKind::kBall: return 3;
    case JointKind::kHinge: return 5;
    case JointKind::kWeld: return 6;
  }
  return 0;
}

void append_joint_rows(const JointLink& joint, const Body& a, int index_a, const Body& b,
                       int index_b, std::vector<Constraint>& rows) {
  const Vector3d r_a = a.world_from_body * joint.a.point_body,
                 r_b = b.world_from_body * joint.b.point_body;
  const PointMotion motion = point_motion(a, r_a, b, r_b);
  append_point_rows(motion, r_a, r_b, index_a, index_b, rows);
  if (joint.kind == JointKind::kBall) return;
  const Matrix3d axes_a = (a.world_from_body * joint.a_from_joint).toRotationMatrix(),
                 axes_b = (b.world_from_body * joint.b_from_joint).toRotationMatrix();
  append_axes_row(axes_a.col(0), a, index_a, axes_b.col(2), b, index_b, rows);
  append_axes_row(axes_a.col(1), a, index_a, axes_b.col(2), b, index_b, rows);
  if (joint.kind == JointKind::kWeld)
    append_axes_row(axes_a.col(0), a, index_a, axes_b.col(1), b, index_b, rows);
}

HingeMotion hinge_motion(const JointLink& joint, const Body& a, const Body& b) {
  const Quaterniond world_from_joint_a = a.world_from_body * joint.a_from_joint;
  const Quaterniond turned =
      world_from_joint_a.conjugate() * (b.world_from_body * joint.b_from_joint);
  const Vector3d axis_world = world_from_joint_a * Vector3d::UnitZ();
  double angle = 2.0 * std::atan2(turned.z(), turned.w());
  if (angle > M_PI) angle -= 2.0 * M_PI;
  if (angle <= -M_PI) angle += 2.0 * M_PI;
  return {angle, axis_world.dot(b.omega_world - a.omega_world), axis_world};
}

}  // namespace tumble::effects
