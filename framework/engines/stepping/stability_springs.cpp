// The fastest swing of a world's springs, and what its dampers take soonest: eigenvalues where the
// run starts.
#include <algorithm>
#include <cmath>

#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "framework/core/decompositions.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/stability.h"

namespace tumble::engines {
namespace {

// More springs than this are judged by the largest row sum (Gershgorin), an upper bound at most
// some times too large.
constexpr Eigen::Index kMostSprings = 400;
// Of linked bodies, six coordinates each: what rods and joints allow is found by a dense
// factorisation.
constexpr Eigen::Index kMostHeldBodies = 60;

/// The movable bodies that links end on, and their coordinates M^1/2 u, in which every direction is
/// as easy to move.
class LinkedCoordinates {
 public:
  LinkedCoordinates(const World& world, const std::vector<effects::StiffRow>& rows,
                    const std::vector<Constraint>& held)
      : world_(world), place_(world.bodies.size(), -1) {
    for (const effects::StiffRow& row : rows) take(row.body_a), take(row.body_b);
    for (const Constraint& row : held) take(row.body_a), take(row.body_b);
  }

  Eigen::Index size() const { return 6 * bodies_; }
  // of its first coordinate
  Eigen::Index place(int body) const { return place_[static_cast<std::size_t>(body)]; }
  bool is_movable(int body) const {
    return body >= 0 && place_[static_cast<std::size_t>(body)] >= 0;
  }

  /// Adds J M^-1/2 of one body. @param jacobian  (6), (linear, angular), world
  void add(int body, const Vector6d& jacobian, Eigen::Ref<VectorXd> row) const {
    if (!is_movable(body)) return;
    const WorldBody& moved = world_.bodies[static_cast<std::size_t>(body)];
    const Matrix3d R = moved.state.world_from_body.toRotationMatrix();
    const Matrix3d root = symmetric_root(moved.inertia.inverse_inertia_body);
    row.segment<3>(place_[static_cast<std::size_t>(body)]) +=
        std::sqrt(moved.inertia.inverse_mass) * jacobian.head<3>();
    row.segment<3>(place_[static_cast<std::size_t>(body)] + 3) +=
        root * (R.transpose() * jacobian.tail<3>());
  }

 private:
  void take(int body) {
    if (body < 0 || world_.bodies[static_cast<std::size_t>(body)].immovable() || is_movable(body))
      return;
    place_[static_cast<std::size_t>(body)] = 6 * bodies_++;
  }

  const World& world_;
  std::vector<Eigen::Index> place_;
  Eigen::Index bodies_ = 0;
};

/// One column for each thing that rods and joints hold.
MatrixXd held_directions(const std::vector<Constraint>& held, const LinkedCoordinates& linked) {
  MatrixXd directions = MatrixXd::Zero(linked.size(), static_cast<Eigen::Index>(held.size()));
  for (std::size_t k = 0; k < held.size(); ++k) {
    linked.add(held[k].body_a, held[k].row.jacobian_a,
               directions.col(static_cast<Eigen::Index>(k)));
    linked.add(held[k].body_b, held[k].row.jacobian_b,
               directions.col(static_cast<Eigen::Index>(k)));
  }
  return directions;
}

using Sparse = Eigen::SparseMatrix<double>;

/// J M^-1/2 of each row, one column a row, without what rods and joints hold; zero for rows that
/// are not judged.
Sparse ways_of(const World& world, const std::vector<effects::StiffRow>& rows) {
  std::vector<RigidBodyState> start;
  for (const WorldBody& body : world.bodies) start.push_back(body.state);
  std::vector<Constraint> holding;
  for (const effects::Effect* effect : effects::all())
    effect->append_held_rows(world, start, holding);
  const LinkedCoordinates linked(world, rows, holding);
  const bool is_small = linked.size() <= 6 * kMostHeldBodies;
  std::vector<bool> is_held(world.bodies.size(), false);
  for (const Constraint& row : holding)
    for (const int body : {row.body_a, row.body_b})
      if (body >= 0) is_held[static_cast<std::size_t>(body)] = true;

  Sparse ways(linked.size(), static_cast<Eigen::Index>(rows.size()));
  VectorXd way = VectorXd::Zero(linked.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const effects::StiffRow& row = rows[k];
    const auto held = [&](int body) {
      return body >= 0 && is_held[static_cast<std::size_t>(body)];
    };
    if (!is_small && (held(row.body_a) || held(row.body_b))) continue;
    linked.add(row.body_a, row.jacobian_a, way);
    linked.add(row.body_b, row.jacobian_b, way);
    for (const int body : {row.body_a, row.body_b}) {
      if (!linked.is_movable(body)) continue;
      for (Eigen::Index i = linked.place(body); i < linked.place(body) + 6; ++i) {
        if (way[i] != 0.0) ways.coeffRef(i, static_cast<Eigen::Index>(k)) = way[i];
        way[i] = 0.0;
      }
    }
  }
  if (holding.empty() || !is_small) return ways;
  const MatrixXd directions = held_directions(holding, linked), free(ways);
  // redundant rows are allowed
  return MatrixXd(free - directions * least_squares(directions, free)).sparseView();
}

/// The way of moving on which a diagonal D over the rows acts most: x^T J^T D J x where x^T M x =
/// 1.
struct MostActedOn {
  Eigen::Index row = 0;  // that takes most part in it
  double most = 0.0;     // of D
  double other = 0.0;    // the same sum of another diagonal
};

MostActedOn most_acted_on(const Sparse& shared, const VectorXd& diagonal, const VectorXd& other) {
  const VectorXd root = diagonal.cwiseSqrt();
  const Sparse scaled = root.asDiagonal() * shared * root.asDiagonal();
  MostActedOn result;
  if (shared.rows() > kMostSprings) {
    result.most = (scaled.cwiseAbs() * VectorXd::Ones(shared.rows())).maxCoeff(&result.row);
    result.other =
        diagonal[result.row] > 0 ? result.most * other[result.row] / diagonal[result.row] : 0.0;
    return result;
  }
  const SymmetricEigen eigen = symmetric_eigen(MatrixXd(scaled));
  const VectorXd part = eigen.vectors.rightCols<1>();
  result.most = eigen.values[shared.rows() - 1];
  part.cwiseAbs().maxCoeff(&result.row);
  if (result.most > 0)
    result.other = other.dot((shared * root.cwiseProduct(part)).cwiseAbs2()) / result.most;
  return result;
}

/// What draws bodies back where the run starts, what its directions share of the ways in which
/// bodies can move, and its constants.
struct StiffRows {
  explicit StiffRows(const World& world) {
    std::vector<RigidBodyState> start;
    for (const WorldBody& body : world.bodies) start.push_back(body.state);
    for (const effects::Effect* effect : effects::all())
      effect->append_stiff_rows(world, start, rows);
    stiffness.resize(static_cast<Eigen::Index>(rows.size()));
    damping.resize(stiffness.size());
    for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
      stiffness[i] = rows[static_cast<std::size_t>(i)].stiffness;
      damping[i] = rows[static_cast<std::size_t>(i)].damping;
    }
  }
  Sparse shared(const World& world) const {
    const Sparse ways = ways_of(world, rows);
    return ways.transpose() * ways;
  }
  const effects::StiffRow& at(Eigen::Index k) const { return rows[static_cast<std::size_t>(k)]; }

  std::vector<effects::StiffRow> rows;
  VectorXd stiffness, damping;
};

}  // namespace

std::optional<SpringStability> judge_springs(const World& world, const Laws& laws, double step) {
  const StiffRows springs(world);
  if (springs.rows.empty()) return std::nullopt;
  const MostActedOn swing =
      most_acted_on(springs.shared(world), springs.stiffness, springs.damping);
  if (!(swing.most > 0)) return std::nullopt;
  const double frequency = std::sqrt(swing.most), damping = swing.other;
  const effects::StiffRow& most = springs.at(swing.row);
  return SpringStability{most.of,
                         frequency,
                         damping,
                         amplification(laws, frequency, damping, step),
                         largest_stable_step(laws, frequency, damping, step),
                         most.remedy,
                         most.last_remedy};
}

std::optional<StepLimit> judge_dampers(const World& world, const Laws& laws, double step) {
  const StiffRows springs(world);
  if (std::none_of(springs.rows.begin(), springs.rows.end(),
                   [](const effects::StiffRow& row) { return row.damping > 0; }))
    return std::nullopt;
  const MostActedOn decay =
      most_acted_on(springs.shared(world), springs.damping, springs.stiffness);
  const double frequency = std::sqrt(decay.other), damping = decay.most;
  if (!(damping > 2.0 * frequency)) return std::nullopt;
  const double amplified = amplification(laws, frequency, damping, step);
  if (!(amplified > 1.0 + kNegligible)) return std::nullopt;
  return StepLimit{
      fmt::format("what the damper of {} takes from velocities ({:.4g} 1/s where the run starts)",
                  springs.at(decay.row).of, damping),
      amplified, largest_stable_step(laws, frequency, damping, step), "less damping"};
}

}  // namespace tumble::engines
