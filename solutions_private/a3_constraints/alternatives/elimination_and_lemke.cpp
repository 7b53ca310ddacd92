// Another right solution: the skyline of A eliminated row by row in the order given, dependent rows
// skipped; contacts by Lemke's method with the lexicographic rule, which never runs in circles
// (Cottle, Pang, Stone 1992, section 4.9).
#include "assignments/a3_constraints/a3_constraints.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/QR>

namespace tumble::a3 {

Vector3d anchor_position(const Body& body, const Vector3d& point_body) {
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return R * point_body + body.com_world;
}

Vector3d anchor_velocity(const Body& body, const Vector3d& point_body) {
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  const Vector3d r = R * point_body;
  return body.velocity_world - r.cross(body.omega_world);
}

Vector3d spring_force(const Spring& spring, const AnchorState& a, const AnchorState& b) {
  const Vector3d d = b.point_world - a.point_world;
  const double length = d.stableNorm();
  if (length == 0.0) return Vector3d::Zero();
  const Vector3d n = d / length;
  Vector3d force = spring.stiffness * d;  // k |d| n
  force -= spring.stiffness * spring.rest_length * n;
  force += spring.damping * n.dot(b.velocity_world - a.velocity_world) * n;
  return force;
}

ConstraintRow rod_row(const Body& a, const Vector3d& point_a_body, const Body& b,
                      const Vector3d& point_b_body, double length) {
  const Vector3d d = anchor_position(a, point_a_body) - anchor_position(b, point_b_body);
  const Vector3d d_rate = anchor_velocity(a, point_a_body) - anchor_velocity(b, point_b_body);
  const double distance = d.norm();
  ConstraintRow row{Vector6d::Zero(), Vector6d::Zero(), distance - length, 0.0, 0.0};
  if (distance == 0.0) return row;
  const Vector3d n = d / distance;
  const Vector3d r_a = a.world_from_body * point_a_body, r_b = b.world_from_body * point_b_body;
  row.jacobian_a << n, r_a.cross(n);
  row.jacobian_b << -n, n.cross(r_b);
  row.rate = n.dot(d_rate);
  // w x (w x r) = w (w . r) - r w^2
  const Vector3d turn_a =
      a.omega_world * a.omega_world.dot(r_a) - r_a * a.omega_world.squaredNorm();
  const Vector3d turn_b =
      b.omega_world * b.omega_world.dot(r_b) - r_b * b.omega_world.squaredNorm();
  row.velocity_product =
      n.dot(turn_a - turn_b) + (d_rate.squaredNorm() - row.rate * row.rate) / distance;
  return row;
}

double baumgarte_acceleration(double value, double rate, double time_constant_s) {
  return -(2 * rate + value / time_constant_s) / time_constant_s;
}

namespace {

Vector6d per_mass(const ConstrainedBody& body, const Vector6d& force) {
  Vector6d u;
  u.head<3>() = body.inverse_mass * force.head<3>();
  u.tail<3>() = body.inverse_inertia_world * force.tail<3>();
  return u;
}

/// Row i of the lower triangle from its first entry on: for a chain, two numbers.
struct SkylineRow {
  std::size_t first = 0;
  std::vector<double> entries;
  double& at(std::size_t k) { return entries[k - first]; }
  double get(std::size_t k) const { return k < first ? 0.0 : entries[k - first]; }
};

VectorXd solve_rows(const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies,
                    const VectorXd& right) {
  const std::size_t m = rows.size();
  std::vector<std::vector<std::size_t>> of_body(bodies.size());
  for (std::size_t i = 0; i < m; ++i)
    for (const int k : {rows[i].body_a, rows[i].body_b})
      if (bodies[static_cast<std::size_t>(k)].inverse_mass > 0)
        of_body[static_cast<std::size_t>(k)].push_back(i);

  const auto side = [&](std::size_t i, int body) {
    return body == rows[i].body_a ? rows[i].row.jacobian_a : rows[i].row.jacobian_b;
  };
  std::vector<double> scale(m, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    const auto& [a, b, row] = rows[i];
    const double diagonal =
        row.jacobian_a.dot(per_mass(bodies[static_cast<std::size_t>(a)], row.jacobian_a)) +
        row.jacobian_b.dot(per_mass(bodies[static_cast<std::size_t>(b)], row.jacobian_b));
    if (diagonal > 0) scale[i] = 1 / std::sqrt(diagonal);
  }
  std::vector<SkylineRow> A(m);
  for (std::size_t i = 0; i < m; ++i) {
    A[i].first = i;
    for (const int k : {rows[i].body_a, rows[i].body_b})
      if (bodies[static_cast<std::size_t>(k)].inverse_mass > 0)
        A[i].first = std::min(A[i].first, of_body[static_cast<std::size_t>(k)].front());
    A[i].entries.assign(i - A[i].first + 1, 0.0);
    for (const int k : {rows[i].body_a, rows[i].body_b}) {
      if (!(bodies[static_cast<std::size_t>(k)].inverse_mass > 0)) continue;
      const Vector6d moved = per_mass(bodies[static_cast<std::size_t>(k)], side(i, k));
      for (const std::size_t j : of_body[static_cast<std::size_t>(k)])
        if (j <= i) A[i].at(j) += scale[i] * scale[j] * moved.dot(side(j, k));
    }
  }

  // A = L D L^T by rows; a pivot of round-off is a row that says what rows before it say, and is
  // left out.
  std::vector<SkylineRow> L = A;
  std::vector<double> inverse_pivot(m, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    double pivot = A[i].get(i);
    for (std::size_t j = A[i].first; j < i; ++j) {
      double y = A[i].get(j);
      for (std::size_t k = std::max(A[i].first, L[j].first); k < j; ++k)
        y -= L[i].get(k) * L[j].get(k);
      L[i].at(j) = y;  // L_ij d_j for now
    }
    for (std::size_t j = A[i].first; j < i; ++j) {
      const double y = L[i].get(j);
      L[i].at(j) = y * inverse_pivot[j];
      pivot -= y * L[i].get(j);
    }
    // Rows j below use L_ik d_k with L_jk: keep the product's other half for them.
    inverse_pivot[i] = pivot > 1e-12 ? 1 / pivot : 0.0;
    for (std::size_t j = A[i].first; j < i; ++j)
      if (inverse_pivot[j] == 0) L[i].at(j) = 0;
  }
  const auto solve_once = [&](VectorXd x) {
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t k = L[i].first; k < i; ++k)
        x[static_cast<Eigen::Index>(i)] -= L[i].get(k) * x[static_cast<Eigen::Index>(k)];
    for (std::size_t i = 0; i < m; ++i) x[static_cast<Eigen::Index>(i)] *= inverse_pivot[i];
    for (std::size_t i = m; i-- > 0;)
      for (std::size_t k = L[i].first; k < i; ++k)
        x[static_cast<Eigen::Index>(k)] -= L[i].get(k) * x[static_cast<Eigen::Index>(i)];
    return x;
  };
  const Eigen::Map<const VectorXd> s(scale.data(), static_cast<Eigen::Index>(m));
  VectorXd x = VectorXd::Zero(right.size()), left = s.cwiseProduct(right);
  for (int round = 0; round < 3; ++round) {
    x += solve_once(left);
    VectorXd u = VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies.size()));
    for (std::size_t i = 0; i < m; ++i) {
      const double lambda = scale[i] * x[static_cast<Eigen::Index>(i)];
      u.segment<6>(6 * rows[i].body_a) += lambda * rows[i].row.jacobian_a;
      u.segment<6>(6 * rows[i].body_b) += lambda * rows[i].row.jacobian_b;
    }
    for (std::size_t k = 0; k < bodies.size(); ++k)
      u.segment<6>(6 * static_cast<Eigen::Index>(k)) =
          per_mass(bodies[k], u.segment<6>(6 * static_cast<Eigen::Index>(k)));
    for (std::size_t i = 0; i < m; ++i)
      left[static_cast<Eigen::Index>(i)] =
          scale[i] * (right[static_cast<Eigen::Index>(i)] -
                      rows[i].row.jacobian_a.dot(u.segment<6>(6 * rows[i].body_a)) -
                      rows[i].row.jacobian_b.dot(u.segment<6>(6 * rows[i].body_b)));
  }
  return s.cwiseProduct(x);
}

}  // namespace

VectorXd constraint_multipliers(const std::vector<Constraint>& rows,
                                const std::vector<ConstrainedBody>& bodies,
                                const VectorXd& wanted_acceleration) {
  VectorXd right = wanted_acceleration;
  Eigen::Index i = 0;
  for (const auto& [a, b, row] : rows) {
    right[i] -= row.velocity_product;
    right[i] -= row.jacobian_a.dot(bodies[static_cast<std::size_t>(a)].free_acceleration);
    right[i] -= row.jacobian_b.dot(bodies[static_cast<std::size_t>(b)].free_acceleration);
    ++i;
  }
  return solve_rows(rows, bodies, right);
}

VectorXd constraint_correction(const std::vector<Constraint>& rows,
                               const std::vector<ConstrainedBody>& bodies, const VectorXd& error) {
  const VectorXd lambda = solve_rows(rows, bodies, -error);
  VectorXd x = VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies.size()));
  Eigen::Index i = 0;
  for (const auto& [a, b, row] : rows) {
    x.segment<6>(6 * a) +=
        per_mass(bodies[static_cast<std::size_t>(a)], lambda[i] * row.jacobian_a);
    x.segment<6>(6 * b) +=
        per_mass(bodies[static_cast<std::size_t>(b)], lambda[i] * row.jacobian_b);
    ++i;
  }
  return x;
}

namespace {

/// Lemke's method with the lexicographic rule: w = A z + q + e z0, one of w_i, z_i in the basis, z0
/// driven out of it.
class Lemke {
 public:
  Lemke(const MatrixXd& A, const VectorXd& q)
      : m_(q.size()), table_(m_, 2 * m_ + 2), basis_(static_cast<std::size_t>(m_)) {
    table_ << MatrixXd::Identity(m_, m_), -A, -VectorXd::Ones(m_), q;
    for (Eigen::Index i = 0; i < m_; ++i) basis_[static_cast<std::size_t>(i)] = i;
  }

  /// The contacts that push.
  std::vector<Eigen::Index> find() {
    std::vector<Eigen::Index> pushing;
    if (m_ == 0 || table_.col(2 * m_ + 1).minCoeff() >= 0) return pushing;
    Eigen::Index row = 0;
    for (Eigen::Index i = 1; i < m_; ++i)
      if (comes_before(i, 1.0, row, 1.0)) row = i;
    Eigen::Index leaving = pivot(row, 2 * m_);
    for (int round = 0; round < 50 * static_cast<int>(m_) + 100 && leaving != 2 * m_; ++round) {
      const Eigen::Index entering = leaving < m_ ? leaving + m_ : leaving - m_;
      row = -1;
      for (Eigen::Index i = 0; i < m_; ++i) {
        const double step = table_(i, entering);
        if (step > 1e-10 && (row < 0 || comes_before(i, step, row, table_(row, entering)))) row = i;
      }
      if (row < 0) break;  // no solution this way
      leaving = pivot(row, entering);
    }
    for (const Eigen::Index k : basis_)
      if (k >= m_ && k < 2 * m_) pushing.push_back(k - m_);
    std::sort(pushing.begin(), pushing.end());
    return pushing;
  }

 private:
  /// Row i over its step is lexicographically less than row k over its own: right-hand sides first,
  /// then what were unit columns. On equality z0 leaves first.
  bool comes_before(Eigen::Index i, double step_i, Eigen::Index k, double step_k) const {
    constexpr double kEqual = 1e-11;
    for (Eigen::Index column = -1; column < m_; ++column) {
      const Eigen::Index c = column < 0 ? 2 * m_ + 1 : column;
      const double difference = (table_(i, c) / step_i - table_(k, c) / step_k);
      if (std::abs(difference) > kEqual) return difference < 0;
      if (column < 0 && basis_[static_cast<std::size_t>(i)] == 2 * m_) return true;
      if (column < 0 && basis_[static_cast<std::size_t>(k)] == 2 * m_) return false;
    }
    return false;
  }

  /// @return what left the basis
  Eigen::Index pivot(Eigen::Index row, Eigen::Index entering) {
    table_.row(row) /= table_(row, entering);
    for (Eigen::Index i = 0; i < m_; ++i)
      if (i != row) table_.row(i) -= table_(i, entering) * table_.row(row);
    return std::exchange(basis_[static_cast<std::size_t>(row)], entering);
  }

  Eigen::Index m_;
  MatrixXd table_;
  std::vector<Eigen::Index> basis_;
};

}  // namespace

VectorXd contact_forces(const MatrixXd& A, const VectorXd& b) {
  std::vector<Eigen::Index> movable;
  for (Eigen::Index i = 0; i < b.size(); ++i)
    if (A(i, i) > 0) movable.push_back(i);
  VectorXd f = VectorXd::Zero(b.size());
  if (movable.empty()) return f;
  const VectorXd scale = A.diagonal()(movable).cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * MatrixXd(A(movable, movable)) * scale.asDiagonal();
  const VectorXd q = scale.cwiseProduct(VectorXd(b(movable)));
  const double size = q.cwiseAbs().maxCoeff();
  if (size == 0) return f;
  const std::vector<Eigen::Index> pushing = Lemke(scaled, q / size).find();
  if (pushing.empty()) return f;
  // The forces anew from who pushes: what the pivots have rounded is shed.
  const MatrixXd part = scaled(pushing, pushing);
  const VectorXd right = -q(pushing);
  const auto factor = part.colPivHouseholderQr();
  VectorXd x = factor.solve(right);
  x += factor.solve(right - part * x);
  for (std::size_t k = 0; k < pushing.size(); ++k)
    f[movable[static_cast<std::size_t>(pushing[k])]] =
        std::max(0.0, x[static_cast<Eigen::Index>(k)]) * scale[pushing[k]];
  return f;
}

bool ends_in_contact(double approach_speed, double restitution, double rest_speed) {
  const double speed_after = restitution * approach_speed;
  return !(speed_after > rest_speed);
}

}  // namespace tumble::a3
