// Steps of heaps: many bodies without restitution in one group, asked for in steps, not in instants. Part of LastingContacts.
//
// What one blow changes changes dozens of others in the same instant, so that nothing is gained by locating any of them. A heap goes
//   x' = x + h v',   q' = q turned by h omega'
// with the velocities v' that solve the contact problem at the middle of the step, where its surfaces are faced evenly (Moreau's
// midpoint); contacts that would be passed by then are faced at the start. The answer is good to a hundred-thousandth of the heap's
// speed; a shell of that size around each body takes up what is missing, so that gaps stay open.
// Source: J. J. Moreau, "Numerical aspects of the sweeping process", 1999.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/contact/lasting_contacts.h"

namespace tumble::engines {
namespace {

constexpr std::size_t kFew = 12;        // bodies: so many are solved to the last digit
constexpr int kMostLocatedBlows = 8;    // of one heap in a step
constexpr double kRoom = 1e-4;          // of the smaller body: the shell
constexpr double kTooNear = 0.1;        // shells: nearer than this is taken back
constexpr double kPileAtRest = 1e-5;        // of the heap's speed
constexpr double kStill = 1e-3;         // of the rest speed: nor better than this
constexpr double kRestored = 0.2;       // of the shell, in a step: what errors have taken from it comes back without a shift
constexpr int kSweeps = 40;             // from the last step's impulses
constexpr int kShiftSweeps = 40;
constexpr double kShiftTolerance = 1e-2;   // of the farthest: the next round takes the rest
constexpr int kMostPileShifts = 24;         // rounds
constexpr double kPileReach = 1.5;     // shifts: points this far apart may come together by them
constexpr double kDeeperInPile = 1.1, kAsDeep = 0.9;   // of an overlap: a point this deep is no part of it; none that deep has missed it
constexpr double kGoOn = 2.0;           // likewise, in what two bodies have moved by the last shift: levers make it long
constexpr double kMeasured = 10.0;      // shells: of gaps larger than this, and than the rest speed goes in a step, a bound will do
constexpr double kSamePlace = 0.05;     // of the shell: bodies that have moved less since are faced as they were

}  // namespace

bool LastingContacts::is_pile(const Group& group) const {
  if (!group.linked.empty()) return false;
  if (!locates()) return group.bodies.size() > kFew;
  const bool heaped = std::any_of(group.bodies.begin(), group.bodies.end(), [&](int body) { return heaped_.contains(body); });
  return heaped && speed(group) > kMoves * rest_speed_;   // what comes to rest is let down to the last digit
}

void LastingContacts::tell_of_heaps() {
  const std::string words = fmt::format("heaps of more than {} bodies that strike more than {} blows a step go in steps until they lie (heap_steps): right to first order in the step. "
                                        "\"contact\": {{ \"plastic_impacts\": \"located\" }} finds every blow at its instant, and takes longer", kFew, kMostLocatedBlows);
  if (std::find(counters_.notices.begin(), counters_.notices.end(), words) == counters_.notices.end()) counters_.notices.push_back(words);
}

// A blow is about to cut the step for this group: too many of them, and it is asked for in steps from now on, until it rests or falls apart.
bool LastingContacts::becomes_heap(const Group& group) {
  if (rules_.plastic_impacts != scene::PlasticImpacts::kAutomatic || !group.linked.empty() || group.bodies.size() <= kFew) return false;
  if (!(moving_.time() < counted_from_ + step_)) {
    counted_from_ = moving_.time();
    blows_.clear();
  }
  if (++blows_[group.bodies.front()] <= kMostLocatedBlows) return false;
  heaped_.insert(group.bodies.begin(), group.bodies.end());
  tell_of_heaps();
  return true;
}

double LastingContacts::room_of(Pair pair) const {
  return kRoom * size_of(pair);
}

// Where the group's bodies are at the middle of the step if nothing stops them.
std::vector<RigidBodyState> LastingContacts::middle_of(const Group& group, double h) const {
  std::vector<RigidBodyState> middle = moving_.states();
  for (int i = 0; i < moving_.size(); ++i)
    if (moving_.world().bodies[i].immovable()) middle[i].com_world = prescribed_position(moving_.world().bodies[i], moving_.time() + 0.5 * h);
  for (const int index : group.bodies) {
    const Body body = moving_.body_at_impact(index);
    middle[index].com_world += 0.5 * h * body.velocity_world;
    middle[index].world_from_body = turned(middle[index].world_from_body, 0.5 * h * body.omega_world);
  }
  return middle;
}

std::vector<LastingContacts::Touch> LastingContacts::touches_of_pile(const Group& group, const std::vector<RigidBodyState>& middle, double h) {
  std::vector<Touch> touches;
  for (const Pair& pair : group.pairs) {
    const double room = room_of(pair), within = reach(pair);
    Points points = points_at(pair, middle, within);
    const bool passed = std::any_of(points.begin(), points.end(), [](const collision::NearPoint& p) { return p.gap < 0; });
    if (passed) points = points_at(pair, moving_.states(), within);
    const Body a = moving_.body_at_impact(pair.first), b = moving_.body_at_impact(pair.second);
    for (const collision::NearPoint& p : points) {
      double target = (room - p.gap) / h;
      if (!passed) {
        const Vector3d point = point_of(pair, p);
        const Vector3d v = a.velocity_world + a.omega_world.cross(point - a.com_world) - b.velocity_world - b.omega_world.cross(point - b.com_world);
        target += 0.5 * p.normal_b_to_a_world.dot(v);
      }
      if (target > 0) target = kRestored * std::max(0.0, room - p.gap) / step_;   // not / h: in a step cut short that would be a blow
      touches.push_back({pair, p, target, false});
    }
  }
  return touches;
}

// @return an earlier target to begin the step again with
std::optional<double> LastingContacts::take_pile_step(const Group& group, double h) {
  const std::vector<RigidBodyState> middle = middle_of(group, h);
  const std::vector<Touch> touches = touches_of_pile(group, middle, h);
  const ContactProblem problem = problem_of(group, touches, middle, h);
  ContactOptions options;
  options.tolerance = kPileAtRest;
  options.least_speed = kStill * rest_speed_;
  options.most_sweeps_alone = kSweeps;
  if (locates()) {           // nobody has asked for steps: their problems are at least solved
    options.enough = kPileAtRest;
    options.most_sweeps = kSweeps;
  } else {
    options.largest_direct = 0;
  }
  ++counters_.heap_steps;
  ++counters_.contact_solves;
  counters_.contact_points += problem.contacts.size();
  const ContactSolution solution = laws_.friction_impulses ? laws_.friction_impulses(problem, options) : solve_contacts(problem, options);
  counters_.contact_sweeps += static_cast<std::uint64_t>(solution.sweeps);
  counters_.contact_factorisations += static_cast<std::uint64_t>(solution.factorisations);
  if (!solution.converged) ++counters_.contact_unsolved;
  require_numbers(group, solution);
  std::vector<RigidBodyState> ends = ends_of(group, problem, solution, h, true);
  // Pairs with bodies of other groups may meet within the step: that is for the finding of impacts.
  std::vector<double> gaps(group.pairs.size(), 0.0);
  const bool apart = keep_pile_apart(group, group.pairs, ends, moving_.target(), gaps);
  if (!apart && h > kShortest * step_) return moving_.time() + 0.5 * h;
  for (const int body : group.bodies) {
    set_straight_path(body, ends[body]);
    moving_.refuse_whirl(body);
  }
  keep_warm(group, touches, problem, solution, h);
  return std::nullopt;
}

// How far any point of a body goes by a shift, at most. [m]
double LastingContacts::way_of(int body, const Velocity& shift) const {
  return shift.linear_world.norm() + shift.angular_world.norm() * moving_.shape(body).bounding_radius();
}

// Shifts the group's bodies until no gap of these pairs is closed. @param gaps  bounds from below, by pair; as good as needed afterwards
// @return whether that was reached
bool LastingContacts::keep_pile_apart(const Group& group, const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t, std::vector<double>& gaps) {
  for (int i = 0; i < moving_.size(); ++i)
    if (moving_.world().bodies[i].immovable()) states[i].com_world = prescribed_position(moving_.world().bodies[i], t);
  std::vector<double> way(states.size(), 0.0);
  std::vector<Faced> faced(pairs.size());
  for (int round = 0; round < kMostPileShifts; ++round) {
    double wrong = 0.0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const double least = kTooNear * room_of(pairs[k]);
      const double moved = way[pairs[k].first] + way[pairs[k].second];
      faced[k].moved += moved;
      gaps[k] -= moved;
      if (gaps[k] >= least) continue;
      gaps[k] = least_gap_of(pairs[k], states);
      if (gaps[k] < least) gaps[k] = distance_of(pairs[k], states, std::max(kMeasured * room_of(pairs[k]), rest_speed_ * step_));
      if (gaps[k] < least) wrong = std::max(wrong, room_of(pairs[k]) - gaps[k]);
    }
    if (wrong == 0.0) return true;
    ++counters_.nudges;
    const ContactSolution shift = solve_contacts(shifts_of(group, pairs, states, t, gaps, wrong, way, faced), {.tolerance = kShiftTolerance, .largest_direct = 0, .most_sweeps_alone = kShiftSweeps});
    counters_.contact_sweeps += static_cast<std::uint64_t>(shift.sweeps);
    for (std::size_t k = 0; k < group.bodies.size(); ++k) {
      const int body = group.bodies[k];
      way[body] = apply_shift(body, shift.velocities[k], states) ? way_of(body, shift.velocities[k]) : 0.0;
    }
  }
  return false;
}

// Of two that overlap by `gap`: columns through their surfaces may go in and out elsewhere, deeper than the two are or not as deep.
LastingContacts::Points LastingContacts::points_of_overlap(Pair pair, const std::vector<RigidBodyState>& states, double reach, double gap) const {
  Points points = points_at(pair, states, reach);
  if (gap >= 0.0) return points;
  std::erase_if(points, [&](const collision::NearPoint& p) { return p.gap < kDeeperInPile * gap; });
  if (std::any_of(points.begin(), points.end(), [&](const collision::NearPoint& p) { return p.gap < kAsDeep * gap; })) return points;
  const collision::Gap deepest = gap_of(pair, states);
  points.push_back({deepest.point_a_world, deepest.point_b_world, deepest.normal_b_to_a_world, deepest.distance});
  return points;
}

ContactProblem LastingContacts::shifts_of(const Group& group, const std::vector<Pair>& pairs, const std::vector<RigidBodyState>& states, double t, const std::vector<double>& gaps, double wrong, const std::vector<double>& way, std::vector<Faced>& faced) {
  ContactProblem problem;
  std::map<int, int> places;
  for (const int body : group.bodies) place(body, t, places, states, nullptr, problem);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double reach = std::max(kPileReach * wrong, kGoOn * (way[pairs[k].first] + way[pairs[k].second]));
    if (gaps[k] >= reach) continue;
    if (!(faced[k].reach >= reach && faced[k].moved <= kSamePlace * room_of(pairs[k]))) faced[k] = {points_of_overlap(pairs[k], states, reach, gaps[k]), reach, 0.0};
    for (const collision::NearPoint& point : faced[k].points) {
      if (point.gap > reach) continue;
      PushingContact contact;
      place_for_shift(group, pairs[k], point, states, t, room_of(pairs[k]), places, problem, contact);
      problem.contacts.push_back(contact);
    }
  }
  return problem;
}

}  // namespace tumble::engines
