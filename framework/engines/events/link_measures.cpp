#include "framework/engines/events/link_measures.h"

#include <algorithm>

namespace tumble::engines {

LinkMeasures::LinkMeasures(const FlightWorld& world, const Laws& laws) : world_(world) {
  for (std::size_t k = 0; k < effects::all().size(); ++k)
    if (auto forces =
            effects::all()[k]->steady_forces({world.world(), laws, uncounted_.effect_calls[k]}))
      forces_.emplace(static_cast<int>(k), std::move(forces));
  for (LinkedGroup& group : groups_of_linked_bodies(world.world()))
    groups_.emplace_back(
        world.world(), laws, uncounted_,
        [this](int body, const RigidBodyState& state) { return wrench_on(body, state); },
        std::move(group));
}

Wrench LinkMeasures::wrench_on(int body, const RigidBodyState& state) const {
  Wrench sum{Vector3d::Zero(), Vector3d::Zero()};
  for (const auto& [effect, forces] : forces_) forces->add(body, state, sum);
  return sum;
}

void LinkMeasures::measure(Frame& frame, const FlightOf& flight_of) {
  const World& world = world_.world();
  LinkForces forces(world);
  std::vector<RigidBodyState> states;
  for (int i = 0; i < world_.size(); ++i)
    states.push_back(world_.state(i, flight_of(i), frame.time));
  for (const int body : world_.movers()) {
    const Flight& flight = flight_of(body);
    if (flight.segment < 0 || world_.first_member(body, flight) != body) continue;
    const std::vector<ContactPoint>& contacts =
        world_.processes()->segments().step_at(flight.segment, frame.time).forces;
    frame.contacts.insert(frame.contacts.end(), contacts.begin(), contacts.end());
  }
  for (LinkedBodies& group : groups_) {
    const ProcessState& from = world_.processes()
                                   ->segments()
                                   .step_at(flight_of(group.bodies().front()).segment, frame.time)
                                   .from;
    group.remember(from.remembered);
    for (const auto& [effect, forces] : forces_) {
      const auto memory = from.remembered.find(effect);
      forces->stand_at(
          from.time, memory == from.remembered.end() ? effects::Memory{} : memory->second, states);
    }
    group.measure(states, frame.time, frame.contacts, forces);
  }
  record(std::move(forces), frame);
}

std::vector<Event> force_switches(const World& world, double until) {
  std::vector<Event> events;
  for (const effects::Effect* effect : effects::all())
    for (const effects::Switch& one : effect->switches(world))
      if (one.event.time <= until) events.push_back(one.event);
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.time < b.time; });
  return events;
}

}  // namespace tumble::engines
