// Steps of large islands: many bodies without restitution, solved in steps and not at instants.
// Part of PersistentContacts.
//
// One impact changes dozens of others in the same instant, so nothing is gained by locating any of
// them. A large island goes
//   x' = x + h v',   q' = q turned by h omega'
// with the velocities v' that solve the contact problem at the middle of the step, where surfaces
// are met evenly (Moreau's midpoint); contacts that would be passed by then are met at the start.
// The answer is good to a hundred-thousandth of the island's speed; a margin of that size around
// each body takes up the error, so that gaps stay open.
// Source: J. J. Moreau, "Numerical aspects of the sweeping process", 1999.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/persistent_contacts.h"

namespace tumble::engines {

bool PersistentContacts::is_large(const ContactIsland& island) const {
  if (!island.linked.empty()) return false;
  if (!locates()) return island.bodies.size() > kContact.few_bodies;
  const bool in_large_island =
      std::any_of(island.bodies.begin(), island.bodies.end(),
                  [&](int body) { return memory_.in_large_island.contains(body); });
  // what comes to rest is let down to the last digit
  return in_large_island && speed(island) > kContact.moving * restitution_threshold_;
}

void PersistentContacts::report_large_islands() {
  const std::string words = fmt::format(
      "islands of more than {} bodies with more than {} impacts a step are solved in steps until "
      "they rest (large_island_steps): right to first order in the step. "
      "\"contact\": {{ \"plastic_impacts\": \"located\" }} finds every impact at its instant, and "
      "takes longer",
      kContact.few_bodies, kContact.most_located_impacts);
  counters_.watch.say("large islands", moving_.time(), words);
}

// An impact is about to cut the step for this island. Too many of them, and it is solved in steps
// from now on, until it rests or separates.
bool PersistentContacts::becomes_large(const ContactIsland& island) {
  if (rules_.plastic_impacts != scene::PlasticImpacts::kAutomatic || !island.linked.empty() ||
      island.bodies.size() <= kContact.few_bodies)
    return false;
  if (!(moving_.time() < memory_.impacts_counted_from + memory_.longest_step)) {
    memory_.impacts_counted_from = moving_.time();
    memory_.impacts_counted.clear();
  }
  if (++memory_.impacts_counted[island.bodies.front()] <= kContact.most_located_impacts)
    return false;
  memory_.in_large_island.insert(island.bodies.begin(), island.bodies.end());
  report_large_islands();
  return true;
}

// Where the island's bodies are at the middle of the step if nothing stops them.
std::vector<RigidBodyState> PersistentContacts::middle_of(const ContactIsland& island,
                                                          double h) const {
  std::vector<RigidBodyState> middle = moving_.states();
  for (int i = 0; i < moving_.size(); ++i)
    if (moving_.world().bodies[i].immovable())
      middle[i].com_world =
          prescribed_position(moving_.world().bodies[i], moving_.time() + 0.5 * h);
  for (const int index : island.bodies) {
    const Body body = moving_.body_at_impact(index);
    middle[index].com_world += 0.5 * h * body.velocity_world;
    middle[index].world_from_body =
        turned(middle[index].world_from_body, 0.5 * h * body.omega_world);
  }
  return middle;
}

StepContacts PersistentContacts::contacts_of_large_island(const ContactIsland& island,
                                                          const std::vector<RigidBodyState>& middle,
                                                          double h) {
  StepContacts contacts;
  for (const Pair& pair : island.pairs) {
    if (!reach_.may_meet(pair)) continue;
    const double margin = geometry_.large_island_margin(pair), within = reach_.of(pair);
    ContactManifold points = geometry_.points_at(pair, middle, within);
    const bool passed = std::any_of(points.begin(), points.end(),
                                    [](const collision::ManifoldPoint& p) { return p.gap < 0; });
    if (passed) points = geometry_.points_at(pair, moving_.states(), within);
    for (const collision::ManifoldPoint& p : points) {
      // from the middle the half of the way is left
      if (!reach_.may_close(pair, p, passed ? h : 0.5 * h)) continue;
      double target = (margin - p.gap) / h;
      if (!passed) {
        const Vector3d point = geometry_.point_of(pair, p);
        target += 0.5 * p.normal_b_to_a_world.dot(reach_.velocity_of_point(pair.first, point) -
                                                  reach_.velocity_of_point(pair.second, point));
      }
      // not / h: in a step cut short that would be an impact
      if (target > 0)
        target = kContact.restored * std::max(0.0, margin - p.gap) / memory_.longest_step;
      contacts.push_back({pair, p, target, false});
    }
  }
  return contacts;
}

// @return an earlier target to begin the step again with
std::optional<double> PersistentContacts::take_large_island_step(const ContactIsland& island,
                                                                 double h) {
  const std::vector<RigidBodyState> middle = middle_of(island, h);
  const StepContacts contacts = contacts_of_large_island(island, middle, h);
  const ContactProblem problem = problem_of(island, contacts, middle, h);
  ContactOptions options;
  options.tolerance = kContact.solved_in_large_island;
  options.least_speed = kContact.still * restitution_threshold_;
  options.most_sweeps_alone = kContact.sweeps_in_large_island;
  if (locates()) {  // the scene does not ask for steps: their problems are solved at least
    options.enough = kContact.solved_in_large_island;
    options.most_sweeps = kContact.sweeps_in_large_island;
  } else {
    options.largest_direct = 0;
  }
  ++counters_.large_island_steps;
  counters_.watch.note_large_island(moving_.time());
  ++counters_.contact_solves;
  counters_.contact_points += problem.contacts.size();
  const ContactSolution solution = laws_.friction_impulses
                                       ? laws_.friction_impulses(problem, options)
                                       : solve_contacts(problem, options);
  counters_.contact_sweeps += static_cast<std::uint64_t>(solution.sweeps);
  counters_.contact_factorisations += static_cast<std::uint64_t>(solution.factorisations);
  if (!solution.converged) ++counters_.contact_unsolved;
  require_numbers(island, solution);
  find_ends(island, problem, solution, h, true);
  // Pairs with bodies of other groups may meet within the step: that is for the finding of impacts.
  std::vector<double> gaps(island.pairs.size(), 0.0);
  const bool apart =
      correction_.correct_large_island(island, island.pairs, ends_, moving_.target(), gaps);
  for (const int body : moving_.driven_bodies()) ends_[body] = moving_.state(body);
  if (!apart && h > kContact.shortest_step * memory_.longest_step) return moving_.time() + 0.5 * h;
  for (const int body : island.bodies) {
    set_straight_path(body, ends_[body]);
    moving_.refuse_fast_turning(body);
  }
  keep_warm_start(island, contacts, problem, solution, h);
  return std::nullopt;
}

}  // namespace tumble::engines
