// Reference solution of assignment 3. Equations (A3.n) stand in a3_constraints.h and in the
// handout.
#include "assignments/a3_constraints/a3_constraints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/SparseCholesky>

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

/// L D L^T of a symmetric matrix whose rows are given from their first entry to the diagonal:
/// nothing outside of that envelope ever fills, so that a chain whose links stand in order costs a
/// few operations a link and no search for an order of elimination. A pivot of round-off is a row
/// that says what those before it say: its unknown is 0.
class Envelope {
 public:
  /// @param first  (m), the column of each row's first entry, at most the row itself
  explicit Envelope(std::vector<Eigen::Index> first)
      : first_(std::move(first)), origin_(first_.size()), inverse_pivots_(first_.size(), 0.0) {
    Eigen::Index stored = 0;
    for (std::size_t i = 0; i < first_.size(); ++i) {
      origin_[i] = stored - first_[i];
      stored += static_cast<Eigen::Index>(i) - first_[i] + 1;
    }
    entries_.assign(static_cast<std::size_t>(stored), 0.0);
  }

  Eigen::Index first(Eigen::Index i) const { return first_[static_cast<std::size_t>(i)]; }
  /// Row i, to be counted by column from the matrix' first.
  double* row(Eigen::Index i) { return entries_.data() + origin_[static_cast<std::size_t>(i)]; }
  const double* row(Eigen::Index i) const {
    return entries_.data() + origin_[static_cast<std::size_t>(i)];
  }

  void factorise(double dependent) {
    for (Eigen::Index i = 0; i < size(); ++i) {
      double* const of_i = row(i);
      const Eigen::Index first_of_i = first(i);
      double pivot = of_i[i];
      // first L_ij D_j, which the columns to come need
      for (Eigen::Index j = first_of_i; j < i; ++j) {
        const Eigen::Index from = std::max(first_of_i, first(j));
        of_i[j] -= product(of_i + from, row(j) + from, j - from);
      }
      for (Eigen::Index j = first_of_i; j < i; ++j) {
        const double times_pivot = of_i[j];
        of_i[j] *= inverse_pivots_[static_cast<std::size_t>(j)];
        pivot -= times_pivot * of_i[j];
      }
      inverse_pivots_[static_cast<std::size_t>(i)] = pivot > dependent ? 1 / pivot : 0.0;
    }
  }

  void solve_in_place(VectorXd& unknown) const {
    double* const x = unknown.data();
    for (Eigen::Index i = 0; i < size(); ++i)
      x[i] -= product(row(i) + first(i), x + first(i), i - first(i));
    for (Eigen::Index i = 0; i < size(); ++i) x[i] *= inverse_pivots_[static_cast<std::size_t>(i)];
    for (Eigen::Index i = size(); i-- != 0;) {
      const double* const of_i = row(i);
      const double x_i = x[i];
      for (Eigen::Index k = first(i); k < i; ++k) x[k] -= of_i[k] * x_i;
    }
  }

 private:
  /// Two sums side by side: neither waits for the other.
  static double product(const double* a, const double* b, Eigen::Index count) {
    double even = 0.0, odd = 0.0;
    Eigen::Index k = 0;
    for (; k + 1 < count; k += 2) {
      even += a[k] * b[k];
      odd += a[k + 1] * b[k + 1];
    }
    if (k < count) even += a[k] * b[k];
    return even + odd;
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(first_.size()); }

  std::vector<Eigen::Index> first_, origin_;
  std::vector<double> entries_, inverse_pivots_;
};

/// A lambda = right-hand side for the rows of a system of bodies, with A scaled to a unit diagonal:
/// rods that hold grams stand beside rods that hold tons.
class RowSystem {
 public:
  RowSystem(const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies)
      : rows_(rows), bodies_(bodies) {
    factorise();
  }

  /// M^-1 J^T lambda, (6n). Forces are summed before they are divided by masses: neighbours'
  /// tensions cancel where they should.
  VectorXd response(const VectorXd& lambda) const {
    VectorXd change = VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double force = lambda[static_cast<Eigen::Index>(i)];
      double* const on_a = change.data() + 6 * rows_[i].body_a;
      double* const on_b = change.data() + 6 * rows_[i].body_b;
      for (int k = 0; k < 6; ++k) on_a[k] += force * rows_[i].row.jacobian_a[k];
      for (int k = 0; k < 6; ++k) on_b[k] += force * rows_[i].row.jacobian_b[k];
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      Eigen::Map<Vector6d> six(change.data() + 6 * i);
      six = accelerated(bodies_[i], six);
    }
    return change;
  }

  /// lambda with A lambda = wanted, by a factorisation, refined once: what is left over is computed
  /// by way of the bodies, in which light and heavy ones do not swallow each other's digits as they
  /// do in A.
  VectorXd solve(const VectorXd& wanted) const {
    VectorXd scaled = scale_.cwiseProduct(wanted);
    solve_once(scaled);
    const VectorXd lambda = scale_.cwiseProduct(scaled);
    VectorXd left = left_over(wanted, response(lambda));
    solve_once(left);
    return lambda + scale_.cwiseProduct(left);
  }

 private:
  static Vector6d accelerated(const ConstrainedBody& body, const Vector6d& force) {
    Vector6d u;
    u.head<3>() = body.inverse_mass * force.head<3>();
    u.tail<3>().noalias() = body.inverse_inertia_world * force.tail<3>();
    return u;
  }

  /// What u does not give of the wanted J u, scaled.
  VectorXd left_over(const VectorXd& wanted, const VectorXd& u) const {
    VectorXd left(wanted.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      left[at] = scale_[at] *
                 (wanted[at] - (product(rows_[i].row.jacobian_a, u.data() + 6 * rows_[i].body_a) +
                                product(rows_[i].row.jacobian_b, u.data() + 6 * rows_[i].body_b)));
    }
    return left;
  }

  static double product(const Vector6d& jacobian, const double* u) {
    return (jacobian[0] * u[0] + jacobian[1] * u[1] + jacobian[2] * u[2]) +
           (jacobian[3] * u[3] + jacobian[4] * u[4] + jacobian[5] * u[5]);
  }

  /// The rows of each body, in order, one body after the other. Rows meet in A where they share a
  /// body that can be moved: the ceiling, which may hold all of them, couples none, and has none
  /// here.
  struct Touching {
    std::vector<std::size_t> rows, begin;  // of body k: rows[begin[k]] to rows[begin[k + 1]]
  };
  Touching rows_touching() const {
    Touching touching;
    std::vector<char> moves;
    moves.reserve(bodies_.size());
    for (const ConstrainedBody& body : bodies_)
      moves.push_back(body.inverse_mass != 0 || !body.inverse_inertia_world.isZero(0));
    const auto for_each_end = [&](const auto& what) {
      for (std::size_t i = 0; i < rows_.size(); ++i)
        for (const int body : {rows_[i].body_a, rows_[i].body_b})
          if (moves[static_cast<std::size_t>(body)]) what(i, static_cast<std::size_t>(body));
    };
    touching.begin.assign(bodies_.size() + 2, 0);
    for_each_end([&](std::size_t, std::size_t body) { ++touching.begin[body + 2]; });
    for (std::size_t k = 2; k < touching.begin.size(); ++k)
      touching.begin[k] += touching.begin[k - 1];
    touching.rows.resize(touching.begin.back());
    for_each_end(
        [&](std::size_t i, std::size_t body) { touching.rows[touching.begin[body + 1]++] = i; });
    return touching;
  }

  /// A, row by row below its diagonal, scaled; and its factor, of whichever kind suits how its rows
  /// meet.
  void factorise() {
    const Touching touching = rows_touching();
    std::vector<Eigen::Index> first(rows_.size());
    std::size_t stored = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      std::size_t least = i;
      for (const int body : {rows_[i].body_a, rows_[i].body_b}) {
        const std::size_t k = touching.begin[static_cast<std::size_t>(body)];
        if (k != touching.begin[static_cast<std::size_t>(body) + 1])
          least = std::min(least, touching.rows[k]);
      }
      first[i] = static_cast<Eigen::Index>(least);
      stored += i - least + 1;
    }
    scale_ = VectorXd::Zero(static_cast<Eigen::Index>(rows_.size()));
    if (stored <= kWide * rows_.size())
      factorise_envelope(std::move(first), touching);
    else
      factorise_sparse(touching);
  }

  /// add(i, j, J_i M^-1 J_j^T of one body) for i >= j.
  template <class Add>
  void for_each_product(const Touching& touching, const Add& add) const {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const auto jacobian = [&](std::size_t i) -> const Vector6d& {
        return rows_[i].body_a == static_cast<int>(k) ? rows_[i].row.jacobian_a
                                                      : rows_[i].row.jacobian_b;
      };
      const std::size_t end = touching.begin[k + 1];
      for (std::size_t at = touching.begin[k]; at != end; ++at) {
        const std::size_t j = touching.rows[at];
        const Vector6d moved = accelerated(bodies_[k], jacobian(j));
        for (std::size_t other = at; other != end; ++other)
          add(touching.rows[other], j, product(jacobian(touching.rows[other]), moved.data()));
      }
    }
  }

  /// The diagonal makes the scale.
  void scale_by_diagonal() { scale_ = (scale_.array() > 0).select(scale_.array().rsqrt(), 0.0); }

  void factorise_envelope(std::vector<Eigen::Index> first, const Touching& touching) {
    envelope_.emplace(std::move(first));
    for_each_product(touching, [&](std::size_t i, std::size_t j, double value) {
      envelope_->row(static_cast<Eigen::Index>(i))[j] += value;
    });
    for (Eigen::Index i = 0; i < scale_.size(); ++i) scale_[i] = envelope_->row(i)[i];
    scale_by_diagonal();
    for (Eigen::Index i = 0; i < scale_.size(); ++i) {
      double* const row = envelope_->row(i);
      for (Eigen::Index j = envelope_->first(i); j < i; ++j) row[j] *= scale_[i] * scale_[j];
      row[i] = 1.0;  // a row that moves nothing stands alone, with 0 to do
    }
    envelope_->factorise(kDependent);
  }

  void factorise_sparse(const Touching& touching) {
    const int m = static_cast<int>(rows_.size());
    std::vector<Eigen::Triplet<double>> entries;
    for_each_product(touching, [&](std::size_t i, std::size_t j, double value) {
      if (i != j)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
      else
        scale_[static_cast<Eigen::Index>(i)] += value;
    });
    scale_by_diagonal();
    for (auto& entry : entries)
      entry = {entry.row(), entry.col(), entry.value() * scale_[entry.row()] * scale_[entry.col()]};
    for (int i = 0; i < m; ++i) entries.emplace_back(i, i, 1.0);
    Eigen::SparseMatrix<double> matrix(m, m);
    matrix.setFromTriplets(entries.begin(), entries.end());
    sparse_.setShift(kShift);
    sparse_.compute(matrix);
    inverse_pivots_ =
        (sparse_.vectorD().array() > kDependent).select(sparse_.vectorD().cwiseInverse(), 0.0);
  }

  void solve_once(VectorXd& x) const {
    if (envelope_) return envelope_->solve_in_place(x);
    VectorXd permuted = sparse_.permutationP() * x;
    sparse_.matrixL().solveInPlace(permuted);
    permuted = inverse_pivots_.cwiseProduct(permuted);
    sparse_.matrixU().solveInPlace(permuted);
    x = sparse_.permutationPinv() * permuted;
  }

  // A row that says what others say leaves a pivot of round-off only, some 1e-16 times the links in
  // the loop. The shift keeps it from being divided by; below kDependent it counts as dependent and
  // its force is left to the others. Masses that differ by 1e6 in a chain of 1,000 leave pivots of
  // 1e-9.
  static constexpr double kShift = 1e-13, kDependent = 2e-12;
  // Entries a row up to which the envelope is the quicker: it multiplies zeros, where the other
  // looks for what is none.
  static constexpr std::size_t kWide = 40;

  const std::vector<Constraint>& rows_;
  const std::vector<ConstrainedBody>& bodies_;
  VectorXd scale_;  // 1 / sqrt(A_ii), or 0 where nothing moves
  std::optional<Envelope> envelope_;
  // where there is no envelope
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>> sparse_;
  // of sparse_
  VectorXd inverse_pivots_;
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
/// with them. A has a unit diagonal.
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
    L_.topLeftCorner(n, n).triangularView<Eigen::Lower>().solveInPlace(column);
    const double pivot = A_(j, j) - column.squaredNorm();
    if (!(pivot > kDependent)) return false;
    L_.row(n).head(n) = column;
    L_(n, n) = std::sqrt(pivot);
    carrying_.push_back(j);
    return true;
  }

  void remove(Eigen::Index place) {
    const std::vector<Eigen::Index> after(carrying_.begin() + place + 1, carrying_.end());
    carrying_.resize(static_cast<std::size_t>(place));
    for (const Eigen::Index j : after) append(j);
  }

  /// x with A_PP x = b_P. @param b  (m), of which the carrying entries count
  VectorXd solve(const VectorXd& b) const {
    VectorXd x = gathered(b);
    const auto L = L_.topLeftCorner(size(), size());
    L.triangularView<Eigen::Lower>().solveInPlace(x);
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
    return x;
  }

 private:
  Eigen::Index size() const { return static_cast<Eigen::Index>(carrying_.size()); }

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
    double least = 0.0;
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      const bool is_violated =
          a[i] < -round_off * size[i] && f_[i] == 0 && !refused_[static_cast<std::size_t>(i)];
      if (is_violated && a[i] < least) least = a[i], worst = i;
    }
    return worst;
  }

  bool let_carry(Eigen::Index j) {
    while (!carriers_.append(j))
      if (!exchange(j)) return false;
    relax();
    return f_[j] > 0;
  }

  /// j's column is a mix of the carriers': force moves from them to j, changing no acceleration,
  /// until one of them is free of it. @return false where none ever is: no forces hold this contact
  bool exchange(Eigen::Index j) {
    const VectorXd mix = carriers_.solve(A_.col(j));
    const auto& carrying = carriers_.indices();
    double step = std::numeric_limits<double>::infinity();
    Eigen::Index first = -1;
    for (Eigen::Index k = 0; k < mix.size(); ++k) {
      if (!(mix[k] > 0)) continue;
      const double at = f_[carrying[static_cast<std::size_t>(k)]] / mix[k];
      if (at < step) step = at, first = k;
    }
    if (first < 0) return false;
    for (Eigen::Index k = 0; k < mix.size(); ++k)
      f_[carrying[static_cast<std::size_t>(k)]] -= step * mix[k];
    f_[j] += step;
    f_[carrying[static_cast<std::size_t>(first)]] = 0;
    carriers_.remove(first);
    return true;
  }

  /// Goes to the forces at which no carrier accelerates; on the way, who reaches 0 lets go.
  void relax() {
    while (!carriers_.indices().empty()) {
      const std::vector<Eigen::Index> carrying = carriers_.indices();
      const VectorXd target = -carriers_.solve(b_);
      double step = 1.0;  // the whole way
      Eigen::Index first = -1;
      for (Eigen::Index k = 0; k < target.size(); ++k) {
        if (target[k] > 0) continue;
        const double f = f_[carrying[static_cast<std::size_t>(k)]];
        const double at = f > 0 ? f / (f - target[k]) : 0.0;
        if (at <= step) step = at, first = k;
      }
      for (Eigen::Index k = 0; k < target.size(); ++k) {
        double& f = f_[carrying[static_cast<std::size_t>(k)]];
        f = (1 - step) * f + step * target[k];
      }
      if (first < 0) return;
      f_[carrying[static_cast<std::size_t>(first)]] = 0;
      carriers_.remove(first);
    }
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
