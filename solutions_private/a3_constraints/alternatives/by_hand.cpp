// A right solution that needs no factorisation of Eigen's: elimination by hand, within the skyline
// of A. It compiles quickly.
#include "assignments/a3_constraints/a3_constraints.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tumble::a3 {

// ---- Anchors and springs ------------------------------------------------------------------------

Vector3d anchor_position(const Body& body, const Vector3d& point_body) {
  return body.com_world + body.world_from_body * point_body;
}

Vector3d anchor_velocity(const Body& body, const Vector3d& point_body) {
  return body.velocity_world + body.omega_world.cross(body.world_from_body * point_body);
}

namespace {

struct Line {
  double length = 0.0;
  Vector3d direction = Vector3d::Zero();  // unit, or zero where there is none
};

/// Length and direction of d, from d brought to the size of 1: |d|^2 would leave the range of
/// doubles at 1e-162 and 1e+154.
Line line_along(const Vector3d& d) {
  const double size = d.cwiseAbs().maxCoeff();
  if (!(size > 0)) return {};
  const Vector3d scaled = d / size;
  const double norm = scaled.norm();
  return {size * norm, scaled / norm};
}

}  // namespace

Vector3d spring_force(const Spring& spring, const AnchorState& a, const AnchorState& b) {
  const Line line = line_along(b.point_world - a.point_world);
  const double stretching = line.direction.dot(b.velocity_world - a.velocity_world);
  return (spring.stiffness * (line.length - spring.rest_length) + spring.damping * stretching) *
         line.direction;
}

// ---- Rods ---------------------------------------------------------------------------------------

ConstraintRow rod_row(const Body& a, const Vector3d& point_a_body, const Body& b,
                      const Vector3d& point_b_body, double length) {
  const Vector3d arm_a = a.world_from_body * point_a_body, arm_b = b.world_from_body * point_b_body;
  // Centres first: two bodies far from the origin and near each other lose no digits to the arms.
  const Line line = line_along((a.com_world - b.com_world) + (arm_a - arm_b));
  const Vector3d& n = line.direction;
  const Vector3d d_rate = anchor_velocity(a, point_a_body) - anchor_velocity(b, point_b_body);

  ConstraintRow row;
  row.value = line.length - length;
  row.rate = n.dot(d_rate);
  row.jacobian_a << n, arm_a.cross(n);
  row.jacobian_b << -n, -arm_b.cross(n);
  row.velocity_product = 0.0;
  if (line.length > 0) {
    const Vector3d centripetal = a.omega_world.cross(a.omega_world.cross(arm_a)) -
                                 b.omega_world.cross(b.omega_world.cross(arm_b));
    // its square is |d'|^2 - (n . d')^2 without the cancellation
    const Vector3d across = d_rate - row.rate * n;
    row.velocity_product = n.dot(centripetal) + across.squaredNorm() / line.length;
  }
  return row;
}

double baumgarte_acceleration(double value, double rate, double time_constant_s) {
  const double T = time_constant_s;
  return -(2 / T) * rate - value / (T * T);
}

// ---- J M^-1 J^T ---------------------------------------------------------------------------------

namespace {

using Row = std::vector<double>;

/// A lambda = right-hand side, by elimination within the skyline of A: for a chain, two numbers a
/// row. A has a unit diagonal.
class RowSystem {
 public:
  RowSystem(const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies)
      : rows_(rows),
        bodies_(bodies),
        scale_(VectorXd::Zero(static_cast<Eigen::Index>(rows.size()))),
        first_(rows.size()),
        entries_(rows.size()),
        inverse_pivots_(rows.size(), 0.0) {
    assemble();
    eliminate();
  }

  /// M^-1 J^T lambda, (6n).
  VectorXd response(const VectorXd& lambda) const {
    VectorXd change = VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      change.segment<6>(6 * rows_[i].body_a) +=
          lambda[static_cast<Eigen::Index>(i)] * rows_[i].row.jacobian_a;
      change.segment<6>(6 * rows_[i].body_b) +=
          lambda[static_cast<Eigen::Index>(i)] * rows_[i].row.jacobian_b;
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      change.segment<6>(6 * static_cast<Eigen::Index>(i)) =
          accelerated(bodies_[i], change.segment<6>(6 * static_cast<Eigen::Index>(i)));
    return change;
  }

  VectorXd solve(const VectorXd& wanted) const {
    VectorXd lambda = VectorXd::Zero(wanted.size()), left = wanted;
    for (int round = 0; round < 3; ++round) {
      lambda += scale_.cwiseProduct(solve_once(scale_.cwiseProduct(left)));
      const VectorXd u = response(lambda);
      for (std::size_t i = 0; i < rows_.size(); ++i)
        left[static_cast<Eigen::Index>(i)] =
            wanted[static_cast<Eigen::Index>(i)] -
            rows_[i].row.jacobian_a.dot(u.segment<6>(6 * rows_[i].body_a)) -
            rows_[i].row.jacobian_b.dot(u.segment<6>(6 * rows_[i].body_b));
    }
    return lambda;
  }

 private:
  static Vector6d accelerated(const ConstrainedBody& body, const Vector6d& force) {
    Vector6d u;
    u << body.inverse_mass * force.head<3>(), body.inverse_inertia_world * force.tail<3>();
    return u;
  }

  void assemble() {
    struct Touch {
      std::size_t row;
      const Vector6d* jacobian;
    };
    std::vector<std::vector<Touch>> touching(bodies_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      touching[static_cast<std::size_t>(rows_[i].body_a)].push_back({i, &rows_[i].row.jacobian_a});
      touching[static_cast<std::size_t>(rows_[i].body_b)].push_back({i, &rows_[i].row.jacobian_b});
      first_[i] = i;
    }
    for (std::size_t k = 0; k < bodies_.size(); ++k)
      for (const Touch& i : touching[k])
        if (bodies_[k].inverse_mass > 0)
          first_[i.row] = std::min(first_[i.row], touching[k].front().row);
    for (std::size_t i = 0; i < rows_.size(); ++i) entries_[i].assign(i - first_[i] + 1, 0.0);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (bodies_[k].inverse_mass == 0) continue;
      for (const Touch& i : touching[k]) {
        const Vector6d moved = accelerated(bodies_[k], *i.jacobian);
        for (const Touch& j : touching[k])
          if (j.row <= i.row) entries_[i.row][j.row - first_[i.row]] += moved.dot(*j.jacobian);
      }
    }
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (entries_[i].back() > 0)
        scale_[static_cast<Eigen::Index>(i)] = 1 / std::sqrt(entries_[i].back());
    for (std::size_t i = 0; i < rows_.size(); ++i)
      for (std::size_t j = first_[i]; j <= i; ++j)
        entries_[i][j - first_[i]] *=
            scale_[static_cast<Eigen::Index>(i)] * scale_[static_cast<Eigen::Index>(j)];
  }

  /// L D L^T. A pivot of round-off is a row that says what rows before it say: it is left out.
  void eliminate() {
    constexpr double kDependent = 1e-12;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Row& row = entries_[i];
      for (std::size_t j = first_[i]; j < i; ++j)
        for (std::size_t k = std::max(first_[i], first_[j]); k < j; ++k)
          row[j - first_[i]] -= row[k - first_[i]] * entries_[j][k - first_[j]];
      double pivot = row.back();
      for (std::size_t j = first_[i]; j < i; ++j) {
        const double before = row[j - first_[i]];
        row[j - first_[i]] = before * inverse_pivots_[j];
        pivot -= before * row[j - first_[i]];
      }
      if (pivot > kDependent) inverse_pivots_[i] = 1 / pivot;
    }
  }

  VectorXd solve_once(VectorXd x) const {
    for (std::size_t i = 0; i < rows_.size(); ++i)
      for (std::size_t k = first_[i]; k < i; ++k)
        x[static_cast<Eigen::Index>(i)] -=
            entries_[i][k - first_[i]] * x[static_cast<Eigen::Index>(k)];
    for (std::size_t i = 0; i < rows_.size(); ++i)
      x[static_cast<Eigen::Index>(i)] *= inverse_pivots_[i];
    for (std::size_t i = rows_.size(); i-- > 0;)
      for (std::size_t k = first_[i]; k < i; ++k)
        x[static_cast<Eigen::Index>(k)] -=
            entries_[i][k - first_[i]] * x[static_cast<Eigen::Index>(i)];
    return x;
  }

  const std::vector<Constraint>& rows_;
  const std::vector<ConstrainedBody>& bodies_;
  VectorXd scale_;                  // 1 / sqrt(A_ii), or 0 where nothing moves
  std::vector<std::size_t> first_;  // of each row, its first column that is not zero
  std::vector<Row> entries_;        // from there to the diagonal
  Row inverse_pivots_;
};

}  // namespace

VectorXd constraint_multipliers(const std::vector<Constraint>& rows,
                                const std::vector<ConstrainedBody>& bodies,
                                const VectorXd& wanted_acceleration) {
  VectorXd right_hand_side = wanted_acceleration;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [a, b, row] = rows[i];
    const double free = row.jacobian_a.dot(bodies[static_cast<std::size_t>(a)].free_acceleration) +
                        row.jacobian_b.dot(bodies[static_cast<std::size_t>(b)].free_acceleration);
    right_hand_side[static_cast<Eigen::Index>(i)] -= free + row.velocity_product;
  }
  return RowSystem(rows, bodies).solve(right_hand_side);
}

VectorXd constraint_correction(const std::vector<Constraint>& rows,
                               const std::vector<ConstrainedBody>& bodies, const VectorXd& error) {
  const RowSystem system(rows, bodies);
  return -system.response(system.solve(error));
}

// ---- Resting contact ----------------------------------------------------------------------------

namespace {

/// Rows and columns of A that carry force now, with their Cholesky factor, which grows and shrinks
/// with them.
class Carriers {
 public:
  explicit Carriers(const MatrixXd& A) : A_(A), L_(A.rows(), A.cols()) {}

  const std::vector<Eigen::Index>& indices() const { return carrying_; }

  /// Appends contact j, unless its column depends on the others'. @return whether it did
  bool append(Eigen::Index j) {
    // of A_jj = 1: round-off leaves some 1e-15, masses 1 : 1e6 leave 1e-7
    constexpr double kDependent = 1e-11;
    const Eigen::Index n = size();
    VectorXd column = gathered(A_.col(j));
    for (Eigen::Index i = 0; i < n; ++i)
      column[i] = (column[i] - L_.row(i).head(i).dot(column.head(i))) / L_(i, i);
    const double pivot = A_(j, j) - column.squaredNorm();
    if (!(pivot > kDependent * A_(j, j))) return false;
    L_.row(n).head(n) = column.transpose();
    L_(n, n) = std::sqrt(pivot);
    carrying_.push_back(j);
    return true;
  }

  void remove(Eigen::Index place) {
    const std::vector<Eigen::Index> after(carrying_.begin() + place + 1, carrying_.end());
    carrying_.resize(static_cast<std::size_t>(place));
    for (const Eigen::Index j : after) append(j);
  }

  /// x with A_PP x = b_P, refined once. @param b  (m), of which the carrying entries count
  VectorXd solve(const VectorXd& b) const {
    const VectorXd right = gathered(b);
    VectorXd x = solve_once(right);
    VectorXd left = right;
    for (Eigen::Index k = 0; k < size(); ++k)
      left -= x[k] * gathered(A_.col(carrying_[static_cast<std::size_t>(k)]));
    return x + solve_once(left);
  }

 private:
  Eigen::Index size() const { return static_cast<Eigen::Index>(carrying_.size()); }

  VectorXd solve_once(VectorXd x) const {
    for (Eigen::Index i = 0; i < size(); ++i)
      x[i] = (x[i] - L_.row(i).head(i).dot(x.head(i))) / L_(i, i);
    for (Eigen::Index i = size(); i-- > 0;) {
      x[i] /= L_(i, i);
      x.head(i) -= x[i] * L_.row(i).head(i).transpose();
    }
    return x;
  }

  VectorXd gathered(const VectorXd& all) const {
    VectorXd some(size());
    for (Eigen::Index k = 0; k < size(); ++k) some[k] = all[carrying_[static_cast<std::size_t>(k)]];
    return some;
  }

  const MatrixXd& A_;
  MatrixXd L_;
  std::vector<Eigen::Index> carrying_;
};

/// f >= 0 that minimises 1/2 f A f + b f, which is (A3.9), by an active set: the contact that is
/// violated most is let carry, the forces follow, and whoever would have to pull lets go. The
/// minimum falls with each round, so no set comes twice. A has a unit diagonal.
class PushingForces {
 public:
  PushingForces(const MatrixXd& A, const VectorXd& b)
      : A_(A),
        b_(b),
        carriers_(A),
        f_(VectorXd::Zero(b.size())),
        refused_(static_cast<std::size_t>(b.size()), false) {}

  VectorXd find() {
    // a few per contact are usual; rounding must not run in circles
    const Eigen::Index most_rounds = 30 * b_.size() + 100;
    for (Eigen::Index round = 0; round < most_rounds; ++round) {
      const Eigen::Index j = most_violated();
      if (j < 0) break;
      const bool carries = let_carry(j);
      if (carries)
        std::fill(refused_.begin(), refused_.end(), false);
      else
        refused_[static_cast<std::size_t>(j)] = true;
    }
    return f_.cwiseMax(0.0);
  }

 private:
  Eigen::Index most_violated() const {
    const double round_off =
        8 * std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(b_.size()));
    const VectorXd a = A_ * f_ + b_, size = A_.cwiseAbs() * f_ + b_.cwiseAbs();
    Eigen::Index worst = -1;
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      const bool is_violated =
          a[i] < -round_off * size[i] && f_[i] == 0 && !refused_[static_cast<std::size_t>(i)];
      if (is_violated && (worst < 0 || a[i] < a[worst])) worst = i;
    }
    return worst;
  }

  bool let_carry(Eigen::Index j) {
    while (!carriers_.append(j))
      if (!exchange(j)) return false;
    return relax() && f_[j] > 0;
  }

  /// j's column is a mix of the carriers': force moves from them to j, changing no acceleration but
  /// that which is violated, until one of them is free of it. @return false where none ever is: no
  /// forces hold this contact
  bool exchange(Eigen::Index j) {
    const VectorXd per_force = -carriers_.solve(A_.col(j));
    const auto& carrying = carriers_.indices();
    double step = std::numeric_limits<double>::infinity();
    Eigen::Index first = -1;
    for (Eigen::Index k = 0; k < per_force.size(); ++k) {
      const double at = per_force[k] < 0 ? f_[carrying[static_cast<std::size_t>(k)]] / -per_force[k]
                                         : std::numeric_limits<double>::infinity();
      if (at < step) step = at, first = k;
    }
    if (first < 0) return false;
    for (Eigen::Index k = 0; k < per_force.size(); ++k)
      f_[carrying[static_cast<std::size_t>(k)]] += step * per_force[k];
    f_[j] += step;
    f_[carrying[static_cast<std::size_t>(first)]] = 0;
    carriers_.remove(first);
    return true;
  }

  /// Goes to the forces at which no carrier accelerates; on the way, who reaches 0 lets go.
  bool relax() {
    while (!carriers_.indices().empty()) {
      const std::vector<Eigen::Index> carrying = carriers_.indices();
      const VectorXd target = -carriers_.solve(b_);
      double step = 1.0;
      Eigen::Index first = -1;
      for (Eigen::Index k = 0; k < target.size(); ++k) {
        const double f = f_[carrying[static_cast<std::size_t>(k)]];
        if (target[k] > 0) continue;
        const double at = f > 0 ? f / (f - target[k]) : 0.0;
        if (first < 0 || at < step) step = at, first = k;
      }
      for (Eigen::Index k = 0; k < target.size(); ++k) {
        double& f = f_[carrying[static_cast<std::size_t>(k)]];
        f = first < 0 ? target[k] : std::max(0.0, f + step * (target[k] - f));
      }
      if (first < 0) return true;
      f_[carrying[static_cast<std::size_t>(first)]] = 0;
      carriers_.remove(first);
    }
    return true;
  }

  const MatrixXd& A_;
  const VectorXd& b_;
  Carriers carriers_;
  VectorXd f_;
  std::vector<bool> refused_;
};

}  // namespace

VectorXd contact_forces(const MatrixXd& A, const VectorXd& b) {
  // Scaled to a unit diagonal; a contact where nothing can be moved takes no part.
  const VectorXd scale = (A.diagonal().array() > 0).select(A.diagonal().array().rsqrt(), 0.0);
  MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  scaled.diagonal().setOnes();
  return scale.cwiseProduct(PushingForces(scaled, scale.cwiseProduct(b)).find());
}

bool ends_in_contact(double approach_speed, double restitution, double rest_speed) {
  return restitution * approach_speed <= rest_speed;
}

}  // namespace tumble::a3
