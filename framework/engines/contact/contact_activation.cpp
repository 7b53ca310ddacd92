#include "framework/engines/contact/contact_activation.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "framework/engines/base/tolerances.h"
#include "framework/engines/base/step_limits.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/impact_bodies.h"

namespace tumble::engines {

bool ContactActivation::is_active(const StepContact& step_contact) const {
  const double margin = geometry_.margin(step_contact.pair);
  return step_contact.point.gap - margin <=
         margin + kContact.still * restitution_threshold_ * memory_.longest_step;
}

// At the step's start; the problem's own are those of its end, of driven bodies too.
std::vector<Velocity> ContactActivation::velocities_now(const ContactIsland& island,
                                                        const StepContacts& contacts,
                                                        const ContactProblem& problem) const {
  std::vector<Velocity> now = velocities_of(problem);
  // the problem's first bodies are the island's
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const Body body = moving_.body_at_impact(island.bodies[k]);
    now[k] = {body.velocity_world, body.omega_world};
  }
  const auto set_driven = [&](int body, int place) {
    if (moving_.is_driven(body))
      now[static_cast<std::size_t>(place)].linear_world = prescribed_velocity(
          moving_.world().bodies[static_cast<std::size_t>(body)], moving_.time());
  };
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    set_driven(contacts[i].pair.first, problem.contacts[i].body_a);
    set_driven(contacts[i].pair.second, problem.contacts[i].body_b);
  }
  return now;
}

bool ContactActivation::allow_separation(const ContactIsland& island, StepContacts& contacts,
                                         ContactProblem& problem) const {
  // what hangs on links is not lifted by itself: their reactions are part of what parts it
  if (!island.linked.empty()) return false;
  const std::vector<Velocity> now = velocities_now(island, contacts, problem);
  bool any = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double separation = -approach_speed(problem, i, now);
    if (contacts[i].activates || !(separation > kSlow * restitution_threshold_)) continue;
    contacts[i].target = problem.contacts[i].target = -separation;
    any = true;
  }
  return any;
}

bool ContactActivation::is_activated(const ContactIsland& island, const StepContacts& contacts,
                                     const ContactProblem& problem, const ContactSolution& solution,
                                     double h) const {
  const std::vector<Velocity> now = velocities_now(island, contacts, problem);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!contacts[i].activates) continue;
    const double way =
        0.5 * h *
        (approach_speed(problem, i, now) + approach_speed(problem, i, solution.velocities));
    if (solution.impulses_world[i].squaredNorm() > 0.0 ||
        way > contacts[i].point.gap - geometry_.margin(contacts[i].pair))
      return true;
  }
  return false;
}

// When gaps close that nothing keeps open, from the velocities at the step's ends:
//   gap(t) = r + v0 t + (v1 - v0) t^2 / (2 h).
std::vector<ContactActivation::Activation> ContactActivation::predict(const ContactIsland& island,
                                                                      const StepContacts& contacts,
                                                                      double h) {
  StepContacts active;
  std::copy_if(contacts.begin(), contacts.end(), std::back_inserter(active),
               [](const StepContact& step_contact) { return !step_contact.activates; });
  const ContactProblem problem = problems_.of(island, contacts, moving_.states(), h);
  const std::vector<Velocity> now = velocities_now(island, contacts, problem);
  std::vector<Velocity> then = velocities_of(problem);
  if (!active.empty() || !problem.rows.empty()) {
    const ContactSolution free =
        problems_.solve(island, problems_.of(island, active, moving_.states(), h), h);
    std::copy_n(free.velocities.begin(), island.bodies.size(), then.begin());
  }
  std::vector<Activation> activations;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!contacts[i].activates) continue;
    const double distance = contacts[i].point.gap - geometry_.margin(contacts[i].pair);
    const double v0 = approach_speed(problem, i, now), v1 = approach_speed(problem, i, then),
                 bend = (v1 - v0) / h;
    const double square = v0 * v0 + 2 * bend * distance, speed = std::sqrt(std::max(0.0, square));
    const bool comes = square >= 0 && v0 + speed > 0;
    // the smaller root, in the form that does not cancel
    const double t = comes ? 2 * distance / (v0 + speed) : h;
    activations.push_back({i, t, speed, v0, comes && t <= h});
  }
  return activations;
}

std::optional<double> ContactActivation::handle(const ContactIsland& island, StepContacts& contacts,
                                                double h) {
  const std::vector<Activation> activations = predict(island, contacts, h);
  std::vector<bool> stays(contacts.size(), true);
  double first = h;
  for (const Activation& activation : activations)
    if (activation.within && activation.speed > restitution_threshold_)
      first = std::min(first, activation.time);
  const double end =
      first <= kContact.soon * memory_.longest_step ? first : kContact.before_activation * first;
  if (first < h && end < (1 - kContact.shortest_step) * h &&
      h > kContact.shortest_step * kContact.soon * memory_.longest_step)
    return moving_.time() + end;
  StepContacts impacts;
  for (const Activation& activation : activations) {
    StepContact& step_contact = contacts[activation.step_contact];
    stays[activation.step_contact] =
        !(activation.within && activation.speed > restitution_threshold_);
    // from this speed evenly to none it closes its gap at the step's end
    const double steady = 2 * (step_contact.point.gap - geometry_.margin(step_contact.pair)) / h;
    step_contact.activates = false;
    step_contact.target = std::min(0.0, activation.approach - steady);
    if (activation.within && stays[activation.step_contact] && activation.approach > steady)
      impacts.push_back({step_contact.pair, step_contact.point, -steady, false});
  }
  if (!impacts.empty()) {
    for (const StepContact& step_contact : contacts)
      if (is_active(step_contact))
        impacts.push_back({step_contact.pair, step_contact.point, 0.0, false});
    if (apply_impact(island, std::move(impacts))) return moving_.target();
  }
  std::size_t i = 0;
  std::erase_if(contacts, [&](const StepContact&) { return !stays[i++]; });
  return std::nullopt;
}

bool ContactActivation::apply_impacts_of_active(const ContactIsland& island,
                                                const StepContacts& contacts) {
  if (std::none_of(contacts.begin(), contacts.end(),
                   [&](const StepContact& step_contact) { return is_active(step_contact); }))
    return false;
  // The corners of an edge that lands flat take part together, though by rounding one of them
  // closes its gap first.
  StepContacts down;
  for (const StepContact& step_contact : contacts) {
    const double size = geometry_.size_of(step_contact.pair);
    if (is_active(step_contact) || step_contact.point.gap < kSixDigits * size)
      down.push_back({step_contact.pair, step_contact.point, 0.0, false});
  }
  return apply_impact(island, std::move(down));
}

bool ContactActivation::apply_impact(const ContactIsland& island, StepContacts down) {
  std::stable_sort(down.begin(), down.end(),
                   [](const StepContact& a, const StepContact& b) { return a.pair < b.pair; });
  const ContactProblem problem = problems_.of(island, down, moving_.states(), 0.0);
  const std::vector<Velocity> before = velocities_of(problem);
  // An approach by less than a margin in a step is left to the step's impulses.
  const bool any = [&] {
    for (std::size_t i = 0; i < down.size(); ++i)
      if ((is_active(down[i]) || down[i].target < 0) &&
          approach_speed(problem, i, before) + down[i].target >
              std::max(kCreep * restitution_threshold_,
                       geometry_.margin(down[i].pair) / memory_.longest_step))
        return true;
    return false;
  }();
  if (!any) return false;
  if (memory_.activated_at != moving_.time()) memory_.activations_there = 0;
  memory_.activated_at = moving_.time();
  if (++memory_.activations_there > kMostIdleSteps) return false;
  const ContactSolution solution = problems_.solve(island, problem, 1.0);
  problems_.note_unsolved(island, solution, memory_.longest_step);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    const Inertia& inertia = moving_.world().bodies[body].inertia;
    RigidBodyState state = moving_.state(body);
    state.momentum_world = inertia.mass * solution.velocities[k].linear_world;
    state.angular_momentum_world =
        angular_momentum_of(solution.velocities[k].angular_world, state.world_from_body, inertia);
    moving_.set_state(body, state);
  }
  ++counters_.contact_activations;
  // The first event has the energy of all; none is given where links end in, or bodies touch, what
  // is driven in different ways.
  const Vector3d driven = ImpactBodies(moving_, laws_)
                              .driven_velocity(touched_bodies(island, down))
                              .value_or(Vector3d::Constant(kUnset));
  EnergyOfImpact energy;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const WorldBody& body = moving_.world().bodies[static_cast<std::size_t>(island.bodies[k])];
    energy.add(body.inertia, moving_.state(island.bodies[k]).world_from_body, before[k],
               solution.velocities[k], driven);
  }
  // The law speaks of contacts: what links do that drift is not theirs.
  EnergyOfImpact by_contacts = energy;
  by_contacts.change -=
      work_of_rows(problem, solution.row_impulses, before, solution.velocities, driven);
  // unsolved: never more is all that can be asked
  double excess = by_contacts.excess(
      solution.converged ? work_of(problem, solution.impulses_world, before, solution.velocities)
                         : by_contacts.change,
      restitution_threshold_);
  // One event a pair: where its impulse is largest, with the sum of all.
  for (std::size_t from = 0, to = 0; from < down.size(); from = to) {
    std::size_t largest = from;
    double impulse = 0.0;
    for (; to < down.size() && down[to].pair == down[from].pair; ++to) {
      impulse += solution.impulses_world[to].dot(problem.contacts[to].normal_b_to_a_world);
      if (solution.impulses_world[to].squaredNorm() >
          solution.impulses_world[largest].squaredNorm())
        largest = to;
    }
    const double speed = approach_speed(problem, largest, before);
    if (!(speed > restitution_threshold_)) continue;
    const PushingContact& c = problem.contacts[largest];
    sink_.event({moving_.time(), EventKind::kCollision, down[largest].pair.first,
                 down[largest].pair.second, c.point_world, c.normal_b_to_a_world, impulse, -speed,
                 -approach_speed(problem, largest, solution.velocities), energy.change, excess});
    energy.change = excess = 0.0;
  }
  return true;
}

}  // namespace tumble::engines
