// Rows of links that say what others say. Part of LinkedBodies.
//
// Loops have them: all axes of a plane linkage are parallel, those of a universal joint or of a
// spherical linkage meet. That holds where the loop is closed, and only there. At a stage of a step
// the loop is open by what the method leaves, e; the rows differ by e there, and if all had to
// hold, they would push with forces of the order 1 / e, which take a mechanism's energy within a
// few steps. So which rows say something new is asked where the step begins, and its stages obey
// these; the others hold because of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "framework/core/decompositions.h"
#include "framework/core/disjoint_sets.h"
#include "framework/dynamics/free_rotation.h"
#include "framework/dynamics/state_units.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/linked_bodies.h"

namespace tumble::engines {
namespace {

// Of the square of a row's length, 1: as much as is left of a row that says what others say. Links
// that are closed leave 1e-14 of rounding, and a four-bar linkage that is stretched to 1e-6 rad of
// its singular posture 1e-12.
constexpr double kRounding = 1e-13;
// Links that are open by a part e of their size leave some e^2. Of links that are open by more than
// a thousandth it cannot be told.
double left_of_redundant(double open_part) {
  constexpr double kOfOpening = 10, kMost = 1e-4;
  return std::clamp(std::pow(kOfOpening * open_part, 2), kRounding, kMost);
}

// Rows of J that span all of them, by G = J J^T: Cholesky with the largest pivot first (Higham,
// "Accuracy and Stability of Numerical Algorithms", section 10.3).
// @param last      by row: taken only beside all others
// @param at_least  so many, as long as more than rounding is left of them
std::vector<char> spanning_rows(MatrixXd G, const std::vector<char>& last, std::size_t at_least,
                                double threshold) {
  const auto m = static_cast<std::size_t>(G.rows());
  std::vector<char> chosen(m, 0);
  for (std::size_t count = 0; count < m; ++count) {
    int pivot = -1;
    for (const bool is_last : {false, true})
      for (std::size_t i = 0; i < m && (!is_last || pivot < 0); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        if (chosen[i] == 0 && (last[i] != 0) == is_last &&
            G(k, k) > (count < at_least ? kRounding : threshold) &&
            (pivot < 0 || G(k, k) > G(pivot, pivot)))
          pivot = static_cast<int>(i);
      }
    if (pivot < 0) break;
    chosen[static_cast<std::size_t>(pivot)] = 1;
    const VectorXd column = G.col(pivot) / std::sqrt(G(pivot, pivot));
    G.noalias() -= column * column.transpose();
  }
  return chosen;
}

/// Rows of many links, each with a block of six numbers for either of its bodies.
class SparseRows {
 public:
  explicit SparseRows(std::size_t bodies) : columns_(6 * static_cast<Eigen::Index>(bodies)) {}

  /// A row, drawn to unit length. @param blocks  by place; what stands at no body is not kept
  /// @return the length that it has; 1 where that is 0
  double append(std::array<std::pair<int, Vector6d>, 2> blocks) {
    double square = 0.0;
    for (auto& [place, block] : blocks) {
      if (6 * place >= columns_) {
        block.setZero();
        place = 0;
      }
      square += block.squaredNorm();
    }
    const double length = square > 0.0 ? std::sqrt(square) : 1.0;
    for (auto& [place, block] : blocks) block /= length;
    rows_.push_back(blocks);
    return length;
  }
  VectorXd times(const VectorXd& x) const {
    VectorXd y = VectorXd::Zero(static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (const auto& [place, block] : rows_[k])
        y[static_cast<Eigen::Index>(k)] += block.dot(x.segment<6>(6 * place));
    return y;
  }
  VectorXd transposed_times(const VectorXd& y) const {
    VectorXd x = VectorXd::Zero(columns_);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (const auto& [place, block] : rows_[k])
        x.segment<6>(6 * place) += y[static_cast<Eigen::Index>(k)] * block;
    return x;
  }

 private:
  Eigen::Index columns_;
  std::vector<std::array<std::pair<int, Vector6d>, 2>> rows_;
};

// What is left of b where the range of A is taken out of it: the residual of least squares, by
// conjugate gradients on A^T A x = A^T b (Hestenes, Stiefel 1952; Bjorck, "Numerical Methods for
// Least Squares Problems", 1996, algorithm 7.4.1). Nothing where it is not found in a bounded time.
template <class A, class At>
std::optional<VectorXd> outside_range(const A& times, const At& transposed_times,
                                      const VectorXd& b) {
  constexpr double kFound = 1e-9;  // of b: what the range may leave
  constexpr double kSteps = 4e6;   // rows times iterations: some 0.2 s
  VectorXd left = b, gradient = transposed_times(left), way = gradient;
  double square = gradient.squaredNorm();
  const double enough = kFound * b.norm();
  const auto most = static_cast<int>(kSteps / static_cast<double>(b.size() + gradient.size()));
  for (int k = 0; k < most; ++k) {
    if (!(std::sqrt(square) > enough)) return left;
    const VectorXd along = times(way);
    left -= square / along.squaredNorm() * along;
    gradient = transposed_times(left);
    const double before = std::exchange(square, gradient.squaredNorm());
    way = gradient + square / before * way;
  }
  return std::nullopt;
}

}  // namespace

// Whether links close a loop: the world and all that cannot move is one node.
bool LinkedBodies::closes_loop(const LinkedGroup& group) const {
  const int immovable = static_cast<int>(bodies_.size());
  DisjointSets joined(immovable + 1);
  for (const Terms& terms : terms_) {
    if (terms.acting->row_count() == 0) continue;
    for (const int entry : group.entries.at(terms.effect)) {
      std::vector<int> ends;
      for (const int body : effects::all()[terms.effect]->bodies_of(world_, entry)) {
        const auto found = std::lower_bound(bodies_.begin(), bodies_.end(), body);
        if (found != bodies_.end() && *found == body)
          ends.push_back(static_cast<int>(found - bodies_.begin()));
      }
      if (ends.size() < 2) ends.push_back(immovable);
      if (joined.find(ends.front()) == joined.find(ends.back())) return true;
      joined.unite(ends.front(), ends.back());
    }
  }
  return false;
}

// What is redundant by proportions is so everywhere: asked where the scene begins.
bool LinkedBodies::has_redundant_rows() {
  if (!has_small_loop_) return false;
  if (!rank_at_start_) {
    std::vector<RigidBodyState> start;
    for (const int body : bodies_)
      start.push_back(world_.bodies[static_cast<std::size_t>(body)].state);
    const std::vector<char> chosen = spanning(place_bodies(start, 0.0), 0);
    rank_at_start_ = static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), 1));
  }
  return *rank_at_start_ < row_count_;
}

void LinkedBodies::choose_rows(const std::vector<RigidBodyState>& local, double t) {
  obeyed_.clear();
  if (has_redundant_rows()) obeyed_ = spanning(place_bodies(local, t), *rank_at_start_);
}

// Rows of unit length, in which turnings count by the size of the body.
struct LinkedBodies::Directions {
  MatrixXd rows;     // (rows, 6 a body)
  VectorXd lengths;  // by row: what it had before
};

LinkedBodies::Directions LinkedBodies::directions(const std::vector<Constraint>& all,
                                                  const std::vector<Body>& bodies) const {
  const auto m = static_cast<Eigen::Index>(all.size());
  Directions found{MatrixXd::Zero(m, 6 * static_cast<Eigen::Index>(bodies_.size())),
                   VectorXd::Ones(m)};
  MatrixXd& J = found.rows;
  for (Eigen::Index k = 0; k < m; ++k) {
    const auto& [a, b, row] = all[static_cast<std::size_t>(k)];
    for (const auto& [place, jacobian] :
         {std::pair{a, &row.jacobian_a}, std::pair{b, &row.jacobian_b}}) {
      if (static_cast<std::size_t>(place) >= bodies_.size()) continue;
      const double size = radius_of_gyration(bodies[static_cast<std::size_t>(place)].inertia);
      J.row(k).segment<3>(6 * place) += jacobian->head<3>();
      if (size > 0) J.row(k).segment<3>(6 * place + 3) += jacobian->tail<3>() / size;
    }
    if (const double length = J.row(k).norm(); length > 0) {
      J.row(k) /= length;
      found.lengths[k] = length;
    }
  }
  return found;
}

// By row, whether it says something that others do not. Those of a tree come before those that
// close its loops. No mass counts: rows between a heavy and a light body are as good as others.
std::vector<char> LinkedBodies::spanning(const std::vector<Body>& bodies, std::size_t at_least) {
  const std::vector<Constraint> all = rows(bodies);
  const MatrixXd J = directions(all, bodies).rows;
  std::vector<char> last(all.size(), 0);
  for (const int row : loop_rows_) last[static_cast<std::size_t>(row)] = 1;
  return spanning_rows(J * J.transpose(), last, at_least,
                       left_of_redundant(open_part(bodies, all)));
}

// @param chosen  by row; empty: all
std::vector<Constraint> LinkedBodies::those_of(const std::vector<char>& chosen,
                                               std::vector<Constraint> all) {
  if (chosen.empty()) return all;
  std::vector<Constraint> some;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (chosen[k] != 0) some.push_back(all[k]);
  return some;
}

std::vector<Constraint> LinkedBodies::constraint_rows(const std::vector<RigidBodyState>& states,
                                                      double t) {
  if (!has_constraints()) return {};
  const std::vector<Body> bodies = place_bodies(take(states), t);
  std::vector<Constraint> all = rows(bodies);
  if (has_redundant_rows()) all = those_of(spanning(bodies, *rank_at_start_), std::move(all));
  for (Constraint& row : all) {  // all fixed ends are one: none of them moves by an impulse
    row.body_a = std::min(row.body_a, fixed_end());
    row.body_b = std::min(row.body_b, fixed_end());
  }
  return all;
}

// Multipliers that do nothing together, J^T lambda = 0, may be added to any answer. What each link
// pulls with then changes to first order, by both signs of a small part; to second order it changes
// across a force that statics tell, as in a plane linkage by forces along its hinges.
void LinkedBodies::measure_shared(const std::vector<RigidBodyState>& states, double t,
                                  LinkForces& shared) {
  constexpr double kPart = 1e-3;  // of all multipliers
  if (!has_redundant_rows()) return;
  const std::vector<RigidBodyState> local = take(states);
  time_of_stage_ = t;
  const std::vector<Body> bodies = place_bodies(local, t);
  const std::vector<Constraint> all = rows(bodies);
  std::vector<Wrench> wrenches = forces(local, bodies);
  const VectorXd multipliers = add_constraint_forces(all, bodies, local, wrenches);
  const Directions found = directions(all, bodies);
  const double size = found.lengths.cwiseProduct(multipliers).norm();
  if (!(size > 0.0)) return;
  const SymmetricEigen modes = symmetric_eigen(MatrixXd(found.rows * found.rows.transpose()));
  const double redundant = left_of_redundant(open_part(bodies, all));
  for (Eigen::Index mode = 0; mode < modes.values.size(); ++mode) {
    if (modes.values[mode] > redundant) continue;
    const VectorXd change = kPart * size * modes.vectors.col(mode).cwiseQuotient(found.lengths);
    Eigen::Index at = 0;
    for (const Terms& terms : terms_) {
      const auto count = static_cast<Eigen::Index>(terms.acting->row_count());
      std::vector<double>& most = shared.of_effects[terms.effect];
      if (!most.empty() && count > 0) {
        std::vector<double> more(most.size(), 0.0), less(most.size(), 0.0);
        const VectorXd here = multipliers.segment(at, count), by = change.segment(at, count);
        terms.acting->measure(bodies, here + by, more);
        terms.acting->measure(bodies, here - by, less);
        for (std::size_t k = 0; k < most.size(); ++k)
          most[k] = std::max(most[k], std::abs(more[k] - less[k]) / (2.0 * kPart * size));
      }
      at += count;
    }
  }
}

// Along which bodies begin to move, by place: their velocities or, at rest, their accelerations; 0
// where links hold them, but for rounding, against all that acts.
// @return nothing where it is not found
std::optional<std::vector<Vector6d>> LinkedBodies::way_from(
    const std::vector<RigidBodyState>& local, const std::vector<Body>& bodies,
    const std::vector<Constraint>& all) {
  std::vector<Wrench> wrenches = forces(local, bodies);
  const std::vector<ConstrainedBody> held = constrained(bodies);
  const auto accelerations = [&] {
    std::vector<Vector6d> found(bodies_.size(), Vector6d::Zero());
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      found[i] << held[i].inverse_mass * wrenches[i].force_world,
          held[i].inverse_inertia_world * wrenches[i].torque_world;
    return found;
  };
  const double without_links = fastest(accelerations(), bodies);
  std::vector<Vector6d> way(bodies_.size(), Vector6d::Zero());
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    way[i] << bodies[i].velocity_world, bodies[i].omega_world;
  // at rest: slower than what falls by a millionth of the links' length
  const double speed = fastest(way, bodies);
  if (speed * speed > kSixDigits * without_links * length_) return way;
  if (row_count_ > kMostDenseRows) {
    auto found = accelerations_of_many(all, bodies, wrenches);
    if (!found) return std::nullopt;
    way = std::move(*found);
  } else {
    add_constraint_forces(all, bodies, local, wrenches);
    way = accelerations();
  }
  if (!(fastest(way, bodies) > kSixDigits * without_links))
    std::fill(way.begin(), way.end(), Vector6d::Zero());
  return way;
}

// With what rows hold, of bodies at rest, where they are too many for a law that may factorise them
// though some say what others say: of all accelerations that the rows allow those nearest to free
// ones, in the measure of the masses (Gauss's principle). With
// I^-1 = S S and u = (v sqrt m, S^-1 w) that is the plain distance.
std::optional<std::vector<Vector6d>> LinkedBodies::accelerations_of_many(
    const std::vector<Constraint>& all, const std::vector<Body>& bodies,
    const std::vector<Wrench>& wrenches) {
  const std::vector<ConstrainedBody> held = constrained(bodies);
  std::vector<Matrix3d> root(bodies_.size());
  VectorXd free(6 * static_cast<Eigen::Index>(bodies_.size()));
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    root[i] = symmetric_root(held[i].inverse_inertia_world);
    free.segment<6>(6 * static_cast<Eigen::Index>(i))
        << std::sqrt(held[i].inverse_mass) * wrenches[i].force_world,
        root[i] * wrenches[i].torque_world;
  }
  const auto block = [&](int place, const Vector6d& jacobian) {
    const auto i = static_cast<std::size_t>(place);
    Vector6d scaled = Vector6d::Zero();
    if (i < bodies_.size())
      scaled << std::sqrt(held[i].inverse_mass) * jacobian.head<3>(), root[i] * jacobian.tail<3>();
    return std::pair{place, scaled};
  };
  SparseRows rows(bodies_.size());
  for (const auto& [a, b, row] : all)
    rows.append({block(a, row.jacobian_a), block(b, row.jacobian_b)});
  const auto left = outside_range([&](const VectorXd& y) { return rows.transposed_times(y); },
                                  [&](const VectorXd& x) { return rows.times(x); }, free);
  if (!left) return std::nullopt;
  std::vector<Vector6d> found(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Vector6d u = left->segment<6>(6 * static_cast<Eigen::Index>(i));
    found[i] << std::sqrt(held[i].inverse_mass) * u.head<3>(), root[i] * u.tail<3>();
  }
  return found;
}

double LinkedBodies::fastest(const std::vector<Vector6d>& way, const std::vector<Body>& bodies) {
  double most = 0.0;
  for (std::size_t i = 0; i < way.size(); ++i)
    most = std::max(most, way[i].head<3>().norm() +
                              radius_of_gyration(bodies[i].inertia) * way[i].tail<3>().norm());
  return most;
}

struct LinkedBodies::Stretch {
  VectorXd left, lengths;  // by row: of unit length, and the length that it has
};

// What is left of a change of the rows' values that no small places make. @return nothing where it
// is not found
std::optional<LinkedBodies::Stretch> LinkedBodies::stretch_across(
    const std::vector<Constraint>& all, const std::vector<Body>& bodies, const VectorXd& change) {
  if (row_count_ <= kMostDenseRows) {
    Directions found = directions(all, bodies);
    const VectorXd of_unit = change.cwiseQuotient(found.lengths);
    const SymmetricEigen modes = symmetric_eigen(MatrixXd(found.rows * found.rows.transpose()));
    const double redundant = left_of_redundant(open_part(bodies, all));
    VectorXd left = VectorXd::Zero(change.size());
    for (Eigen::Index mode = 0; mode < modes.values.size(); ++mode)
      if (modes.values[mode] <= redundant)
        left += modes.vectors.col(mode).dot(of_unit) * modes.vectors.col(mode);
    return Stretch{std::move(left), std::move(found.lengths)};
  }
  const auto block = [&](int place, const Vector6d& jacobian) {
    const auto i = static_cast<std::size_t>(place);
    Vector6d scaled = Vector6d::Zero();
    if (i >= bodies_.size()) return std::pair{place, scaled};
    const double size = radius_of_gyration(bodies[i].inertia);
    scaled.head<3>() = jacobian.head<3>();
    if (size > 0) scaled.tail<3>() = jacobian.tail<3>() / size;
    return std::pair{place, scaled};
  };
  SparseRows rows(bodies_.size());
  VectorXd lengths(change.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& [a, b, row] = all[k];
    lengths[static_cast<Eigen::Index>(k)] =
        rows.append({block(a, row.jacobian_a), block(b, row.jacobian_b)});
  }
  auto left = outside_range([&](const VectorXd& x) { return rows.times(x); },
                            [&](const VectorXd& y) { return rows.transposed_times(y); },
                            change.cwiseQuotient(lengths));
  if (!left) return std::nullopt;
  return Stretch{std::move(*left), std::move(lengths)};
}

// Along the way that bodies take from here, q + e v, rows change by e^2 v H v / 2. Of a mechanism
// that can go there, other places by e^2 take that back: it is in the range of J. What is left of
// it across all of these, along a null vector of J^T, is as much as links would have to stretch.
void LinkedBodies::measure_stretched(const std::vector<RigidBodyState>& states, double t,
                                     LinkForces& stretched) {
  // of the length of links; what is left of a mechanism's motion is of third order in it
  constexpr double kWay = 1e-3, kLeft = 0.05;
  const bool are_many = row_count_ > kMostDenseRows;
  if (!has_loop_ || (!are_many && !has_redundant_rows()) || !(length_ > 0.0)) return;
  if (std::any_of(fixed_.begin(), fixed_.end(), [&](int fixed) {
        return fixed >= 0 && is_driven(world_.bodies[static_cast<std::size_t>(fixed)].motion);
      }))
    return;  // they go a way of their own
  const std::vector<RigidBodyState> local = take(states);
  time_of_stage_ = t;
  const std::vector<Body> bodies = place_bodies(local, t);
  const std::vector<Constraint> all = rows(bodies);
  const auto found_way = way_from(local, bodies, all);
  if (!found_way) return;
  const std::vector<Vector6d>& way = *found_way;
  const double most = fastest(way, bodies);
  if (!(most > 0.0)) return;
  std::vector<RigidBodyState> moved = local;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    moved[i].com_world += kWay * length_ / most * way[i].head<3>();
    moved[i].world_from_body =
        turned(moved[i].world_from_body, kWay * length_ / most * way[i].tail<3>());
  }
  const std::vector<Constraint> there = rows(place_bodies(moved, t));
  VectorXd change(static_cast<Eigen::Index>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k)
    change[static_cast<Eigen::Index>(k)] = there[k].row.value - all[k].row.value;
  const std::optional<Stretch> stretch = stretch_across(all, bodies, change);
  // a stretch that many links share is small in each
  const double many = std::max(1.0, static_cast<double>(row_count_) / kMostDenseRows),
               least = kLeft * kWay * kWay * length_ / std::sqrt(many);
  if (!stretch || !(stretch->left.norm() > least)) return;
  const VectorXd left = stretch->left.cwiseQuotient(stretch->lengths) / stretch->left.norm();
  Eigen::Index at = 0;
  for (const Terms& terms : terms_) {
    const auto count = static_cast<Eigen::Index>(terms.acting->row_count());
    std::vector<double>& of_links = stretched.of_effects[terms.effect];
    if (!of_links.empty() && count > 0)
      terms.acting->measure(bodies, left.segment(at, count), of_links);
    at += count;
  }
}

}  // namespace tumble::engines
