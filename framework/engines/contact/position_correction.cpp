#include "framework/engines/contact/position_correction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

// A correction is no motion: where masses differ by more than a solver's digits bear, the lightest
// count as heavier ones.
void limit_ratios(ContactProblem& problem) {
  double least = std::numeric_limits<double>::infinity();  // inverse mass of what moves
  for (const PushedBody& body : problem.bodies)
    if (body.inverse_mass > 0) least = std::min(least, body.inverse_mass);
  for (PushedBody& body : problem.bodies) {
    if (!(body.inverse_mass > kContact.most_mass_ratio * least)) continue;
    const double factor = kContact.most_mass_ratio * least / body.inverse_mass;
    body.inverse_mass *= factor;
    body.inverse_inertia_world *= factor;
  }
}

/// How far rods and joints are open, beyond rounding: of rows that ask for a place [m], with
/// `size` the largest coordinate of the bodies [m], and of those that ask for an angle [rad].
double farthest_open(const ContactProblem& problem, double size) {
  double farthest = 0.0;
  for (Eigen::Index i = 0; i < problem.row_targets.size(); ++i) {
    const ConstraintRow& row = problem.rows[static_cast<std::size_t>(i)].row;
    const bool is_angle =
        row.jacobian_a.head<3>().isZero(0.0) && row.jacobian_b.head<3>().isZero(0.0);
    const double off = std::abs(problem.row_targets[i]);
    if (off > kSolverRounding * (is_angle ? 1.0 : size)) farthest = std::max(farthest, off);
  }
  return farthest;
}

}  // namespace

// A contact of a correction: bodies of other islands stay where they are.
void PositionCorrection::place_for_correction(const ContactIsland& island, Pair pair,
                                              const collision::ManifoldPoint& point,
                                              const std::vector<RigidBodyState>& states, double t,
                                              double margin, ContactProblem& problem,
                                              PushingContact& contact) {
  contact.body_a = place_body(moving_, pair.first, t, places_, states, nullptr, problem);
  contact.body_b = place_body(moving_, pair.second, t, places_, states, nullptr, problem);
  for (const int index : {contact.body_a, contact.body_b})
    if (index >= static_cast<int>(island.bodies.size())) {
      problem.bodies[index].inverse_mass = 0.0;
      problem.bodies[index].inverse_inertia_world.setZero();
    }
  contact.point_world = geometry_.point_of(pair, point);
  contact.normal_b_to_a_world = point.normal_b_to_a_world;
  contact.target = margin - point.gap;
}

void PositionCorrection::place_driven(std::vector<RigidBodyState>& states, double t) const {
  for (const int body : moving_.driven_bodies())
    states[body].com_world = prescribed_position(moving_.world().bodies[body], t);
}

// Momenta stay, as no force acts: with the angular velocity kept, a flat body would gain angular
// momentum by each turn. @return whether the body has moved
bool PositionCorrection::apply_correction(int body, const Velocity& correction,
                                          std::vector<RigidBodyState>& states) const {
  if (correction.linear_world.isZero(0.0) && correction.angular_world.isZero(0.0)) return false;
  RigidBodyState& state = states[body];
  state.com_world += correction.linear_world;
  state.world_from_body = turned(state.world_from_body, correction.angular_world);
  return true;
}

bool PositionCorrection::keeps_margin(const Pair& pair, double t) const {
  const auto known = memory_.without_margin.find(pair);
  return known == memory_.without_margin.end() || t >= known->second;
}

// A correction has not helped these. @return whether any of them still kept its margin
bool PositionCorrection::give_up_margins(const std::vector<Pair>& pairs, double t) {
  bool any = false;
  for (const Pair& pair : pairs) {
    if (!keeps_margin(pair, t)) continue;
    memory_.without_margin[pair] = t + kContact.steps_without_margin * memory_.longest_step;
    any = true;
  }
  return any;
}

bool PositionCorrection::Missing::is_between_walls() const {
  for (const Vector3d& one : out_of_walls)
    for (const Vector3d& other : out_of_walls)
      if (one.dot(other) < kContact.against) return true;
  return false;
}

// The island's contacts as they are in these places: what each has to move by. Points farther apart
// than `reach` are no concern.
PositionCorrection::Missing PositionCorrection::add_corrections(
    const ContactIsland& island, const std::vector<Pair>& pairs,
    const std::vector<RigidBodyState>& states, double t, const std::vector<ActiveContact>& active,
    double reach, ContactProblem& problem) {
  Missing missing;
  for (const Pair& pair : pairs) {
    const bool keeps = keeps_margin(pair, t);
    const double size = geometry_.size_of(pair), margin = keeps ? geometry_.margin(pair) : 0.0,
                 too_near = keeps ? 0.5 * margin : -kSolverRounding * size;
    const bool has_active =
        keeps && std::any_of(active.begin(), active.end(),
                             [&](const ActiveContact& h) { return h.pair == pair; });
    bool is_short = false;
    const double far = std::max(
        {kContact.far_at_start * geometry_.margin(pair), reach,
         has_active ? (geometry_.are_balls(pair) ? 1.0 : kContact.active_reach) * size : 0.0});
    missing.reach = std::min(missing.reach, far);
    const ContactManifold points = geometry_.points_at(pair, states, far);
    std::vector<const collision::ManifoldPoint*> at_margin;
    for (const ActiveContact& h : active)
      if (keeps && h.pair == pair)
        at_margin.push_back(
            geometry_.same_point(pair, h.point, *h.at, points, states, geometry_.same_within(pair))
                .point);
    for (const collision::ManifoldPoint& point : points) {
      const bool is_active =
          std::find(at_margin.begin(), at_margin.end(), &point) != at_margin.end();
      if (point.gap < too_near) missing.too_near = std::max(missing.too_near, margin - point.gap);
      if (point.gap < too_near || (is_active && point.gap > 2 * margin))
        missing.farthest = std::max(missing.farthest, std::abs(margin - point.gap));
      is_short = is_short || point.gap < margin;
      if (point.gap < margin && moving_.world().bodies[pair.first].immovable())
        missing.out_of_walls.push_back(-point.normal_b_to_a_world);
      if (point.gap < margin && moving_.world().bodies[pair.second].immovable())
        missing.out_of_walls.push_back(point.normal_b_to_a_world);
      PushingContact contact;
      place_for_correction(island, pair, point, states, t, margin, problem, contact);
      if (is_active) {
        Constraint row;
        row.body_a = contact.body_a;
        row.body_b = contact.body_b;
        const Vector3d& n = contact.normal_b_to_a_world;
        row.row.jacobian_a << n,
            (contact.point_world - problem.bodies[contact.body_a].com_world).cross(n);
        row.row.jacobian_b << -n,
            -(contact.point_world - problem.bodies[contact.body_b].com_world).cross(n);
        row.row.value = -contact.target;
        problem.rows.push_back(row);
      } else {
        problem.contacts.push_back(contact);
      }
    }
    if (is_short) missing.below_margin.push_back(pair);
  }
  return missing;
}

// The correction, minimal in the kinetic metric, that leaves no gap of these pairs below its
// margin, and no rod or joint open; active contacts come to lie at their margin.
// @return whether it was found
bool PositionCorrection::correct_positions(const ContactIsland& island,
                                           const std::vector<Pair>& pairs,
                                           std::vector<RigidBodyState>& states, double t,
                                           const std::vector<ActiveContact>& active) {
  place_driven(states, t);
  double reach = 0.0, before = std::numeric_limits<double>::infinity();
  int rounds_in_vain = 0;
  const bool is_held =
      !island.linked.empty() || std::any_of(pairs.begin(), pairs.end(), [&](const Pair& pair) {
        return moving_.is_driven(pair.first) || moving_.is_driven(pair.second);
      });
  for (int round = 0; round < kContact.most_corrections; ++round) {
    ContactProblem problem;
    places_.begin(moving_.size());
    for (const int body : island.bodies)
      place_body(moving_, body, t, places_, states, nullptr, problem);
    limit_ratios(problem);
    const Missing missing = add_corrections(
        island, pairs, states, t,
        round < kContact.most_corrections / 2 ? active : std::vector<ActiveContact>{}, reach,
        problem);
    const double wrong = missing.farthest;
    // what a correction this long may bring together has to be in it
    if (kContact.correction_reach * wrong > reach) {
      reach = 2 * kContact.correction_reach * wrong;
      // where all points within it are in it already, it counts as the next round's
      if (round == 0 && missing.reach < reach) continue;
      if (round == 0) ++round;
    }
    const std::size_t of_contacts = problem.rows.size();
    add_island_rows(moving_, island, states, t, places_, true, problem);
    double size = 0.0;
    for (const int body : island.bodies)
      size = std::max(size, states[body].com_world.cwiseAbs().maxCoeff());
    const double open = farthest_open(problem, size);
    if (wrong == 0.0 && open == 0.0) return true;
    // Rods, joints and driven bodies often leave no room, two walls may; others give way.
    const double left = std::max(missing.too_near, open);
    rounds_in_vain = left > kContact.correction_stands * before ? rounds_in_vain + 1 : 0;
    if ((is_held && left > kContact.correction_in_vain * before) ||
        (rounds_in_vain >= kContact.most_rounds_in_vain && missing.is_between_walls())) {
      if (!give_up_margins(missing.below_margin, t)) return false;
      before = std::numeric_limits<double>::infinity();
      rounds_in_vain = 0;
      continue;
    }
    before = left;
    ++counters_.position_corrections;
    // The solver measures its answers by the farthest point, which need not move at all. Active
    // points, rods and joints are drawn together by what is of another size.
    double part = 1.0;
    if (problem.rows.empty()) {
      double largest = wrong;
      for (const PushingContact& contact : problem.contacts)
        largest = std::max(largest, std::abs(contact.target));
      part = wrong / largest;
    }
    ContactOptions options;  // the next round takes the rest
    options.tolerance = std::max(kSolverRounding, kContact.correction_missed * part);
    options.enough = std::max(kSolverRounding, kContactSolved * part);
    options.eliminates_links = problem.rows.size() > of_contacts;  // not of active contacts alone
    const ContactSolution correction = solve_contacts(problem, options);
    memory_.sweeps += static_cast<std::uint64_t>(correction.sweeps);
    for (std::size_t k = 0; k < island.bodies.size(); ++k)
      apply_correction(island.bodies[k], correction.velocities[k], states);
  }
  return false;
}

// How far any point of a body goes by a correction, at most. [m]
double PositionCorrection::way_of(int body, const Velocity& correction) const {
  return correction.linear_world.norm() +
         correction.angular_world.norm() * moving_.shape(body).bounding_radius();
}

// Shifts the island's bodies until no gap of these pairs is closed.
// @param gaps  bounds from below, by pair; as good as needed afterwards
// @return whether that was reached
bool PositionCorrection::correct_large_island(const ContactIsland& island,
                                              const std::vector<Pair>& pairs,
                                              std::vector<RigidBodyState>& states, double t,
                                              std::vector<double>& gaps) {
  place_driven(states, t);
  std::vector<double> way(states.size(), 0.0);
  std::vector<KnownManifold> manifolds(pairs.size());
  for (int round = 0; round < kContact.most_corrections_in_large_island; ++round) {
    double wrong = 0.0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const double least = kContact.too_near * geometry_.large_island_margin(pairs[k]);
      const double moved = way[pairs[k].first] + way[pairs[k].second];
      manifolds[k].moved += moved;
      gaps[k] -= moved;
      if (gaps[k] >= least) continue;
      gaps[k] = geometry_.least_gap_of(pairs[k], states);
      if (gaps[k] < least)
        gaps[k] = geometry_.distance_of(
            pairs[k], states,
            std::max(kContact.measured * geometry_.large_island_margin(pairs[k]),
                     restitution_threshold_ * memory_.longest_step));
      if (gaps[k] < least)
        wrong = std::max(wrong, geometry_.large_island_margin(pairs[k]) - gaps[k]);
    }
    if (wrong == 0.0) return true;
    ++counters_.position_corrections;
    const ContactSolution correction =
        solve_contacts(corrections_of(island, pairs, states, t, gaps, wrong, way, manifolds),
                       {.tolerance = kContact.correction_left_in_large_island,
                        .largest_direct = 0,
                        .most_sweeps_alone = kContact.sweeps_in_large_island});
    counters_.contact_sweeps += static_cast<std::uint64_t>(correction.sweeps);
    for (std::size_t k = 0; k < island.bodies.size(); ++k) {
      const int body = island.bodies[k];
      way[body] = apply_correction(body, correction.velocities[k], states)
                      ? way_of(body, correction.velocities[k])
                      : 0.0;
    }
  }
  return false;
}

ContactProblem PositionCorrection::corrections_of(const ContactIsland& island,
                                                  const std::vector<Pair>& pairs,
                                                  const std::vector<RigidBodyState>& states,
                                                  double t, const std::vector<double>& gaps,
                                                  double wrong, const std::vector<double>& way,
                                                  std::vector<KnownManifold>& manifolds) {
  ContactProblem problem;
  places_.begin(moving_.size());
  for (const int body : island.bodies)
    place_body(moving_, body, t, places_, states, nullptr, problem);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double reach = std::max(
        kContact.correction_reach_in_large_island * wrong,
        kContact.correction_moved_in_large_island * (way[pairs[k].first] + way[pairs[k].second]));
    if (gaps[k] >= reach) continue;
    if (!(manifolds[k].reach >= reach &&
          manifolds[k].moved <= kContact.same_place * geometry_.large_island_margin(pairs[k])))
      manifolds[k] = {geometry_.points_of_overlap(pairs[k], states, reach, gaps[k]), reach, 0.0};
    for (const collision::ManifoldPoint& point : manifolds[k].points) {
      if (point.gap > reach) continue;
      PushingContact contact;
      place_for_correction(island, pairs[k], point, states, t,
                           geometry_.large_island_margin(pairs[k]), problem, contact);
      problem.contacts.push_back(contact);
    }
  }
  return problem;
}

}  // namespace tumble::engines
