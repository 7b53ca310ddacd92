#include "framework/engines/contact/large_islands.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "framework/engines/contact/contact_constants.h"

namespace tumble::engines {

bool LargeIslands::is_large(const ContactIsland& island) const {
  if (!island.linked.empty()) return false;
  if (!locates()) return island.bodies.size() > kContact.few_bodies;
  const bool in_large_island =
      std::any_of(island.bodies.begin(), island.bodies.end(),
                  [&](int body) { return memory_.in_large_island.contains(body); });
  // what comes to rest is let down to the last digit
  return in_large_island &&
         fastest_speed(moving_, island) > kContact.moving * restitution_threshold_;
}

void LargeIslands::report() {
  const std::string words = fmt::format(
      "islands of more than {} bodies with more than {} impacts a step are solved in steps until "
      "they rest (large_island_steps): right to first order in the step. "
      "\"contact\": {{ \"plastic_impacts\": \"located\" }} finds every impact at its instant, and "
      "takes longer",
      kContact.few_bodies, kContact.most_located_impacts);
  counters_.watch.say("large islands", moving_.time(), words);
}

bool LargeIslands::becomes_large(const ContactIsland& island) {
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
  report();
  return true;
}

// Where the island's bodies are at the middle of the step if nothing stops them.
std::vector<RigidBodyState> LargeIslands::middle_of(const ContactIsland& island, double h) const {
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

StepContacts LargeIslands::contacts_of(const ContactIsland& island,
                                       const std::vector<RigidBodyState>& middle, double h) {
  StepContacts contacts;
  for (const auto& pair : island.pairs) {
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

LargeIslands::Step LargeIslands::solve(const ContactIsland& island, double h) {
  const std::vector<RigidBodyState> middle = middle_of(island, h);
  StepContacts contacts = contacts_of(island, middle, h);
  ContactProblem problem = problems_.of(island, contacts, middle, h);
  ++counters_.large_island_steps;
  counters_.watch.note_large_island(moving_.time());
  ContactSolution solution = problems_.solve_large(problem);
  problems_.require_numbers(island, solution);
  return {std::move(contacts), std::move(problem), std::move(solution)};
}

}  // namespace tumble::engines
