// Another right solution: a singular problem is solved as a sequence of regular ones, each with a
// little added to the diagonal and the last answer as its starting point; the regular contact
// problems by exchanging all wrong contacts at once (Judice 1994).
#include "assignments/a3_constraints/a3_constraints.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

namespace tumble::a3 {

namespace {

Vector3d cross_matrix_times(const Vector3d& w, const Vector3d& r) {
  Matrix3d W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W * r;
}

}  // namespace

Vector3d anchor_position(const Body& body, const Vector3d& point_body) {
  return body.com_world + body.world_from_body.toRotationMatrix() * point_body;
}

Vector3d anchor_velocity(const Body& body, const Vector3d& point_body) {
  return body.velocity_world +
         cross_matrix_times(body.omega_world, body.world_from_body.toRotationMatrix() * point_body);
}

Vector3d spring_force(const Spring& spring, const AnchorState& a, const AnchorState& b) {
  const Vector3d d = b.point_world - a.point_world;
  const double length = std::hypot(d.x(), d.y(), d.z());
  if (!(length > 0)) return Vector3d::Zero();
  const Vector3d direction(d.x() / length, d.y() / length, d.z() / length);
  const double tension = spring.stiffness * (length - spring.rest_length) +
                         spring.damping * direction.dot(b.velocity_world - a.velocity_world);
  return tension * direction;
}

ConstraintRow rod_row(const Body& a, const Vector3d& point_a_body, const Body& b,
                      const Vector3d& point_b_body, double length) {
  const Vector3d arms[] = {a.world_from_body * point_a_body, b.world_from_body * point_b_body};
  const Vector3d d = a.com_world - b.com_world + arms[0] - arms[1];
  const Vector3d u = anchor_velocity(a, point_a_body) - anchor_velocity(b, point_b_body);
  const double distance = std::hypot(d.x(), d.y(), d.z());
  const Vector3d n = distance > 0 ? Vector3d(d / distance) : Vector3d(Vector3d::Zero());
  ConstraintRow row;
  row.value = distance - length;
  row.jacobian_a << n, cross_matrix_times(arms[0], n);
  row.jacobian_b << -n, cross_matrix_times(n, arms[1]);
  row.rate = n.dot(u);
  const auto inwards = [](const Body& body, const Vector3d& arm) {
    return cross_matrix_times(body.omega_world, cross_matrix_times(body.omega_world, arm));
  };
  row.velocity_product = distance > 0 ? n.dot(inwards(a, arms[0])) - n.dot(inwards(b, arms[1])) +
                                            n.cross(u).squaredNorm() / distance
                                      : 0.0;
  return row;
}

double baumgarte_acceleration(double value, double rate, double time_constant_s) {
  const double frequency = 1 / time_constant_s;
  return -2 * frequency * rate - frequency * frequency * value;
}

namespace {

struct Sparse {
  Eigen::SparseMatrix<double> J;     // (m, 6n), rows scaled
  Eigen::SparseMatrix<double> MiJt;  // M^-1 J^T, (6n, m)
  VectorXd scale;
};

Sparse sparse(const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies) {
  const Eigen::Index m = static_cast<Eigen::Index>(rows.size()),
                     n = 6 * static_cast<Eigen::Index>(bodies.size());
  std::vector<Eigen::Triplet<double>> j, w;
  VectorXd diagonal = VectorXd::Zero(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Constraint& c = rows[static_cast<std::size_t>(i)];
    for (const bool is_a : {true, false}) {
      const int body = is_a ? c.body_a : c.body_b;
      const Vector6d& row = is_a ? c.row.jacobian_a : c.row.jacobian_b;
      const ConstrainedBody& mass = bodies[static_cast<std::size_t>(body)];
      if (mass.inverse_mass == 0) continue;  // takes no part
      Vector6d moved;
      moved << row.head<3>() * mass.inverse_mass, mass.inverse_inertia_world * row.tail<3>();
      diagonal[i] += row.dot(moved);
      for (int k = 0; k < 6; ++k) {
        j.emplace_back(i, 6 * body + k, row[k]);
        w.emplace_back(6 * body + k, i, moved[k]);
      }
    }
  }
  Sparse s;
  s.scale = VectorXd::Zero(m);
  for (Eigen::Index i = 0; i < m; ++i)
    if (diagonal[i] > 0) s.scale[i] = 1 / std::sqrt(diagonal[i]);
  s.J.resize(m, n);
  s.J.setFromTriplets(j.begin(), j.end());
  s.MiJt.resize(n, m);
  s.MiJt.setFromTriplets(w.begin(), w.end());
  s.J = (s.scale.asDiagonal() * s.J).eval();
  s.MiJt = (s.MiJt * s.scale.asDiagonal()).eval();
  return s;
}

/// Scaled multipliers.
VectorXd solved(const Sparse& s, const VectorXd& right) {
  const Eigen::Index m = right.size();
  if (m == 0) return right;
  constexpr double kLittle = 1e-11;
  Eigen::SparseMatrix<double> A = s.J * s.MiJt, little(m, m);
  little.setIdentity();
  A += kLittle * little;
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(A);
  VectorXd x = VectorXd::Zero(m);
  for (int round = 0; round < 5; ++round) {
    const VectorXd left = right - s.J * (s.MiJt * x);
    if (round > 0 && left.norm() < 1e-16 * right.norm()) break;
    x += factor.solve(left);
  }
  return x;
}

}  // namespace

VectorXd constraint_multipliers(const std::vector<Constraint>& rows,
                                const std::vector<ConstrainedBody>& bodies,
                                const VectorXd& wanted_acceleration) {
  const Sparse s = sparse(rows, bodies);
  VectorXd right(wanted_acceleration.size());
  for (Eigen::Index i = 0; i < right.size(); ++i) {
    const Constraint& c = rows[static_cast<std::size_t>(i)];
    const double without =
        c.row.jacobian_a.dot(bodies[static_cast<std::size_t>(c.body_a)].free_acceleration) +
        c.row.jacobian_b.dot(bodies[static_cast<std::size_t>(c.body_b)].free_acceleration) +
        c.row.velocity_product;
    right[i] = s.scale[i] * (wanted_acceleration[i] - without);
  }
  return s.scale.cwiseProduct(solved(s, right));
}

VectorXd constraint_correction(const std::vector<Constraint>& rows,
                               const std::vector<ConstrainedBody>& bodies, const VectorXd& error) {
  const Sparse s = sparse(rows, bodies);
  if (rows.empty()) return VectorXd::Zero(s.MiJt.rows());
  return s.MiJt * solved(s, -s.scale.cwiseProduct(error));
}

namespace {

/// f >= 0, A f + b >= 0, f . a = 0 for A positive definite.
VectorXd regular_contact_forces(const MatrixXd& A, const VectorXd& b, std::vector<bool>& pushes) {
  const Eigen::Index m = b.size();
  Eigen::Index fewest_wrong = m + 1;
  int patience = 5;
  VectorXd f = VectorXd::Zero(m);
  for (int round = 0; round < 40 * static_cast<int>(m) + 100; ++round) {
    std::vector<Eigen::Index> who, wrong;
    for (Eigen::Index i = 0; i < m; ++i)
      if (pushes[static_cast<std::size_t>(i)]) who.push_back(i);
    f.setZero();
    if (!who.empty()) {
      const MatrixXd part = A(who, who);
      const VectorXd right = -b(who);
      const Eigen::LLT<MatrixXd> factor(part);
      VectorXd x = factor.solve(right);
      x += factor.solve(right - part * x);
      f(who) = x;
    }
    const VectorXd a = A * f + b;
    const double round_off = 1e-15 * (b.cwiseAbs().maxCoeff() + f.cwiseAbs().maxCoeff());
    for (Eigen::Index i = 0; i < m; ++i)
      if (pushes[static_cast<std::size_t>(i)] ? f[i] < 0 : a[i] < -round_off) wrong.push_back(i);
    if (wrong.empty()) break;
    const Eigen::Index count = static_cast<Eigen::Index>(wrong.size());
    if (count < fewest_wrong)
      fewest_wrong = count, patience = 5;
    else
      --patience;
    // one at a time, always the last: that cannot circle
    if (patience < 0) wrong.erase(wrong.begin(), wrong.end() - 1);
    for (const Eigen::Index i : wrong)
      pushes[static_cast<std::size_t>(i)] = !pushes[static_cast<std::size_t>(i)];
  }
  return f.cwiseMax(0.0);
}

}  // namespace

VectorXd contact_forces(const MatrixXd& A, const VectorXd& b) {
  const Eigen::Index m = b.size();
  constexpr double kLittle = 1e-10;
  VectorXd scale = VectorXd::Zero(m);
  for (Eigen::Index i = 0; i < m; ++i)
    if (A(i, i) > 0) scale[i] = 1 / std::sqrt(A(i, i));
  MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  const VectorXd right = scale.cwiseProduct(b);
  scaled.diagonal().array() += kLittle;
  std::vector<bool> pushes(static_cast<std::size_t>(m), false);
  VectorXd f = VectorXd::Zero(m);
  for (int round = 0; round < 40; ++round) {
    const VectorXd next = regular_contact_forces(scaled, right - kLittle * f, pushes);
    const double change = (next - f).cwiseAbs().maxCoeff();
    f = next;
    if (change <= 1e-14 * f.maxCoeff()) break;
  }
  return scale.cwiseProduct(f);
}

bool ends_in_contact(double approach_speed, double restitution, double rest_speed) {
  return rest_speed - restitution * approach_speed >= 0;
}

}  // namespace tumble::a3
