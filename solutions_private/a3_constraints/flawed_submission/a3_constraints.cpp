// A submission as they come in the evening before the deadline: springs that forget their length at
// rest, and brake in every direction; a rod whose velocity product holds what turning adds, and not
// that a point that swings past must be bent off its straight path; multipliers by a dense matrix
// that bears no rod twice; contact forces by a hundred sweeps; a correction without masses.
#include "assignments/a3_constraints/a3_constraints.h"

#include <Eigen/LU>

namespace tumble::a3 {

Vector3d anchor_position(const Body& body, const Vector3d& point_body) {
  return body.com_world + body.world_from_body * point_body;
}

Vector3d anchor_velocity(const Body& body, const Vector3d& point_body) {
  Vector3d r = body.world_from_body * point_body;
  return body.velocity_world + body.omega_world.cross(r);
}

Vector3d spring_force(const Spring& spring, const AnchorState& a, const AnchorState& b) {
  Vector3d d = b.point_world - a.point_world;
  double length = d.norm();
  if (length < 1e-12) return Vector3d::Zero();
  Vector3d elastic = spring.stiffness * d;  // F = k x
  // relative velocity times c
  return elastic + spring.damping * (b.velocity_world - a.velocity_world);
}

ConstraintRow rod_row(const Body& a, const Vector3d& point_a_body, const Body& b,
                      const Vector3d& point_b_body, double length) {
  Vector3d d = anchor_position(a, point_a_body) - anchor_position(b, point_b_body);
  Vector3d u = anchor_velocity(a, point_a_body) - anchor_velocity(b, point_b_body);
  Vector3d n = d.normalized();
  Vector3d r_a = a.world_from_body * point_a_body;
  Vector3d r_b = b.world_from_body * point_b_body;
  ConstraintRow row;
  row.value = d.norm() - length;
  row.rate = n.dot(u);
  row.jacobian_a << n, r_a.cross(n);
  row.jacobian_b << -n, -r_b.cross(n);
  Vector3d centripetal_a = a.omega_world.cross(a.omega_world.cross(r_a));
  Vector3d centripetal_b = b.omega_world.cross(b.omega_world.cross(r_b));
  row.velocity_product = n.dot(centripetal_a - centripetal_b);
  return row;
}

double baumgarte_acceleration(double value, double rate, double time_constant_s) {
  return -2 * rate / time_constant_s - value / (time_constant_s * time_constant_s);
}

VectorXd constraint_multipliers(const std::vector<Constraint>& rows,
                                const std::vector<ConstrainedBody>& bodies,
                                const VectorXd& wanted_acceleration) {
  long m = static_cast<long>(rows.size()), n = static_cast<long>(bodies.size());
  MatrixXd J = MatrixXd::Zero(m, 6 * n), W = MatrixXd::Zero(6 * n, 6 * n);
  VectorXd free(6 * n), rhs = wanted_acceleration;
  for (long k = 0; k < n; ++k) {
    const ConstrainedBody& body = bodies[static_cast<std::size_t>(k)];
    W.block<3, 3>(6 * k, 6 * k) = body.inverse_mass * Matrix3d::Identity();
    W.block<3, 3>(6 * k + 3, 6 * k + 3) = body.inverse_inertia_world;
    free.segment<6>(6 * k) = body.free_acceleration;
  }
  for (long i = 0; i < m; ++i) {
    const Constraint& c = rows[static_cast<std::size_t>(i)];
    J.block<1, 6>(i, 6 * c.body_a) = c.row.jacobian_a.transpose();
    J.block<1, 6>(i, 6 * c.body_b) = c.row.jacobian_b.transpose();
    rhs(i) -= c.row.velocity_product;
  }
  MatrixXd A = J * W * J.transpose();
  return A.lu().solve(rhs - J * free);
}

VectorXd constraint_correction(const std::vector<Constraint>& rows,
                               const std::vector<ConstrainedBody>& bodies, const VectorXd& error) {
  long m = static_cast<long>(rows.size()), n = static_cast<long>(bodies.size());
  MatrixXd J = MatrixXd::Zero(m, 6 * n);
  for (long i = 0; i < m; ++i) {
    const Constraint& c = rows[static_cast<std::size_t>(i)];
    if (bodies[static_cast<std::size_t>(c.body_a)].inverse_mass > 0)
      J.block<1, 6>(i, 6 * c.body_a) = c.row.jacobian_a.transpose();
    if (bodies[static_cast<std::size_t>(c.body_b)].inverse_mass > 0)
      J.block<1, 6>(i, 6 * c.body_b) = c.row.jacobian_b.transpose();
  }
  return -J.transpose() * (J * J.transpose()).lu().solve(error);
}

VectorXd contact_forces(const MatrixXd& A, const VectorXd& b) {
  VectorXd f = VectorXd::Zero(b.size());
  for (int sweep = 0; sweep < 100; ++sweep)
    for (long i = 0; i < b.size(); ++i) {
      f(i) -= (A.row(i).dot(f) + b(i)) / A(i, i);
      if (f(i) < 0) f(i) = 0;
    }
  return f;
}

bool ends_in_contact(double approach_speed, double restitution, double rest_speed) {
  return restitution * approach_speed < rest_speed;
}

}  // namespace tumble::a3
