#include "framework/engines/contact/pressed_bodies.h"

#include <cmath>
#include <utility>

#include "framework/engines/contact/contact_constants.h"

namespace tumble::engines {

void PressedBodies::begin_step(const std::vector<ContactIsland>& islands) {
  felt_.clear();
  next_.clear();
  rounds_.clear();
  changes_.clear();
  if (memory_.pressing.empty()) return;
  for (const ContactIsland& island : islands)
    for (const int body : island.bodies)
      if (const auto known = memory_.pressing.find(body); known != memory_.pressing.end())
        felt_.insert(*known);
  moving_.lead_pressed(felt_);
}

bool PressedBodies::finds_other(const ContactIsland& island, const StepContacts& contacts,
                                const ContactProblem& problem, const ContactSolution& solution,
                                double h, const std::vector<RigidBodyState>* ends) {
  std::map<int, Wrench> found;
  bool is_known = true, is_same = true;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    if (!moving_.has_forces_of_motion(body)) continue;
    const Inertia& inertia = moving_.world().bodies[body].inertia;
    const RigidBodyState& at = ends ? (*ends)[body] : moving_.path_end(body);
    const Velocity& after = solution.velocities[k];
    const Wrench now{(inertia.mass / h) * (after.linear_world - problem.bodies[k].velocity_world),
                     angular_momentum_of(after.angular_world - problem.bodies[k].omega_world,
                                         at.world_from_body, inertia) /
                         h};
    found.emplace(body, now);
    is_known = is_known && memory_.pressing.contains(body);
    const auto felt = felt_.find(body);
    const Wrench before =
        felt == felt_.end() ? Wrench{Vector3d::Zero(), Vector3d::Zero()} : felt->second;
    const double largest = now.force_world.norm() * moving_.shape(body).bounding_radius() +
                           now.torque_world.norm();  // N m
    is_same = is_same &&
              (before.force_world - now.force_world).norm() <=
                  kContact.same_pressing * now.force_world.norm() &&
              (before.torque_world - now.torque_world).norm() <= kContact.same_pressing * largest;
  }
  if (found.empty()) return false;
  // what acts at a landing does not last
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].activates && !memory_.persistent.contains(contacts[i].pair) &&
        !solution.impulses_world[i].isZero(0.0)) {
      for (const auto& [body, wrench] : found) next_.erase(body);
      return false;
    }
  const int first = island.bodies.front();
  const bool is_found = is_known || is_same || ++rounds_[first] > 2 * kContact.most_pressing_rounds;
  if (!is_found && rounds_[first] > kContact.most_pressing_rounds)
    found = limit_of(first, found);
  else if (!is_found)
    changes_[first] = changes_from_felt(found);
  // Of a very short step rounding makes forces of its own: what was known before stays.
  const bool is_told = h > kContact.shortest_step_for_pressing * memory_.longest_step;
  for (const auto& [body, wrench] : found) {
    felt_[body] = wrench;
    const auto before = memory_.pressing.find(body);
    if (is_told)
      next_[body] = wrench;
    else if (before != memory_.pressing.end())
      next_.insert(*before);
  }
  if (is_found) return false;
  moving_.lead_pressed(found);
  return true;
}

std::map<int, Wrench> PressedBodies::changes_from_felt(const std::map<int, Wrench>& found) const {
  std::map<int, Wrench> changes;
  for (const auto& [body, wrench] : found) {
    Wrench change = wrench;
    if (const auto felt = felt_.find(body); felt != felt_.end()) {
      change.force_world -= felt->second.force_world;
      change.torque_world -= felt->second.torque_world;
    }
    changes.emplace(body, change);
  }
  return changes;
}

// Where forces take most of a motion within the step, each round leaves a part rho near 1 of the
// change d of the last one: then d + rho d + rho^2 d + ... = d / (1 - rho) is left (Aitken), which
// two rounds in a row tell.
std::map<int, Wrench> PressedBodies::limit_of(int first, const std::map<int, Wrench>& found) {
  constexpr double kSlowest = 0.999;  // of rho: what is slower is no sequence that ends
  const std::map<int, Wrench> changes = changes_from_felt(found);
  const std::map<int, Wrench> before = std::exchange(changes_[first], changes);
  double along = 0.0, square = 0.0;  // (N m)^2
  for (const auto& [body, change] : changes) {
    const auto last = before.find(body);
    if (last == before.end()) return found;
    const double size = std::pow(moving_.shape(body).bounding_radius(), 2);
    along += size * change.force_world.dot(last->second.force_world) +
             change.torque_world.dot(last->second.torque_world);
    square +=
        size * last->second.force_world.squaredNorm() + last->second.torque_world.squaredNorm();
  }
  const double rho = square > 0.0 ? along / square : 0.0;
  if (!(rho < kSlowest)) return found;
  changes_[first].clear();  // two plain rounds tell the next
  std::map<int, Wrench> limit = found;
  for (auto& [body, wrench] : limit) {
    wrench.force_world += rho / (1.0 - rho) * changes.at(body).force_world;
    wrench.torque_world += rho / (1.0 - rho) * changes.at(body).torque_world;
  }
  return limit;
}

}  // namespace tumble::engines
