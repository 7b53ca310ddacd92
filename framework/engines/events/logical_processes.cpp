#include "framework/engines/events/logical_processes.h"

#include <algorithm>

#include "framework/core/disjoint_sets.h"

#include "framework/effects/registry.h"

namespace tumble::engines {
namespace {

// Connected components of members, by their lowest member, in order.
class Components {
 public:
  explicit Components(const std::vector<int>& members)
      : members_(members), sets_(static_cast<int>(members.size())) {}
  bool has(int body) const { return std::binary_search(members_.begin(), members_.end(), body); }
  void join(int a, int b) { sets_.unite(place(a), place(b)); }
  std::vector<std::vector<int>> all() {
    std::vector<std::vector<int>> by_leader(members_.size());
    for (std::size_t k = 0; k < members_.size(); ++k)
      by_leader[static_cast<std::size_t>(sets_.find(static_cast<int>(k)))].push_back(members_[k]);
    std::erase_if(by_leader, [](const auto& component) { return component.empty(); });
    return by_leader;
  }

 private:
  int place(int body) const {
    return static_cast<int>(std::lower_bound(members_.begin(), members_.end(), body) -
                            members_.begin());
  }
  const std::vector<int>& members_;
  DisjointSets sets_;  // by index in members_
};

// Whether some effect may keep a body from flying freely.
bool holds_effects(const World& world) {
  return std::any_of(effects::all().begin(), effects::all().end(),
                     [&](const effects::Effect* effect) {
                       return !effect->traits().leaves_flight && effect->count_in(world) > 0;
                     });
}

}  // namespace

LogicalProcesses::LogicalProcesses(const World& whole, ShapeOf shape_of, const Laws& laws,
                                   ProcessRules rules)
    : whole_(whole),
      segments_(whole, std::move(shape_of), laws, rules),
      holds_any_(holds_effects(whole) || whole.contact.has_value()),
      linked_(whole.bodies.size(), -1) {
  for (const LinkedGroup& group : groups_of_linked_bodies(whole))
    for (const int body : group.bodies)
      linked_[static_cast<std::size_t>(body)] = group.bodies.front();
  segments_.ask([this](const ProcessState& state) { return components_of(state).size() > 1; });
}

bool LogicalProcesses::is_pushed(int body, double t) const {
  return std::any_of(
      effects::all().begin(), effects::all().end(),
      [&](const effects::Effect* effect) { return effect->pushes(whole_, body, t); });
}

LogicalProcesses::Start LogicalProcesses::start(const std::vector<RigidBodyState>& states,
                                                const std::vector<BodyPair>& touching) {
  std::vector<int> movers;
  for (int i = 0; i < static_cast<int>(whole_.bodies.size()); ++i)
    if (!whole_.bodies[static_cast<std::size_t>(i)].immovable()) movers.push_back(i);
  // Components of links, and bodies that do not fly freely.
  Components components(movers);
  std::vector<bool> held(whole_.bodies.size(), false);
  for (const int body : movers) {
    const int first = linked_[static_cast<std::size_t>(body)];
    held[static_cast<std::size_t>(body)] = first >= 0 || is_pushed(body, 0.0);
    if (first >= 0) components.join(first, body);
  }
  // Contacts at the start join components.
  for (const auto& [a, b] : touching) {
    for (const int body : {a, b}) held[static_cast<std::size_t>(body)] = true;
    if (components.has(a) && components.has(b)) components.join(a, b);
  }
  // Each component that does not fly freely begins as a segment, with its contacts.
  Start start;
  for (const std::vector<int>& members : components.all()) {
    if (std::none_of(members.begin(), members.end(),
                     [&](int body) { return held[static_cast<std::size_t>(body)]; }))
      continue;
    ProcessWorld& world = segments_.world_of(members);
    const ProcessState placed = world.at_start(states);
    if (!holds_contacts()) {
      for (BegunFlight& begun : sort(placed)) start.flights.push_back(std::move(begun));
      continue;
    }
    const ProcessWorld::Change change = world.begin_contacts(placed);
    for (BegunFlight& begun : sort(change.after)) start.flights.push_back(std::move(begun));
    start.events.insert(start.events.end(), change.events.begin(), change.events.end());
  }
  return start;
}

ProcessState LogicalProcesses::state_of(int body, const Flight& flight, const RigidBodyState& alone,
                                        double t) {
  if (flight.segment >= 0) {
    ProcessState state = segments_.state_at(flight.segment, t);
    state.contacts.reset();  // bodies of that memory are those of the segment's own world
    return state;
  }
  ProcessState state;
  state.time = t;
  state.members = {body};
  state.states = {alone};
  return state;
}

ProcessState LogicalProcesses::together(const ProcessState& a, const ProcessState& b) {
  ProcessState both;
  both.time = a.time;
  std::merge(a.members.begin(), a.members.end(), b.members.begin(), b.members.end(),
             std::back_inserter(both.members));
  for (const int body : both.members)
    both.states.push_back(std::binary_search(a.members.begin(), a.members.end(), body)
                              ? a.state_of(body)
                              : b.state_of(body));
  for (const ProcessState* state : {&a, &b}) {
    for (const auto& [effect, memory] : state->remembered)
      both.remembered[effect].insert(memory.begin(), memory.end());
    both.met.insert(state->met.begin(), state->met.end());
    both.lasting.insert(state->lasting.begin(), state->lasting.end());
    both.pressing.insert(state->pressing.begin(), state->pressing.end());
  }
  return both;
}

ProcessState LogicalProcesses::on_constraints(ProcessState state) {
  const bool is_linked = std::any_of(state.members.begin(), state.members.end(), [&](int body) {
    return linked_[static_cast<std::size_t>(body)] >= 0;
  });
  return is_linked ? segments_.world_of(state.members).on_constraints(state) : state;
}

std::vector<BodyPair> LogicalProcesses::ties_of(const ProcessState& state) const {
  std::set<BodyPair> ties;
  for (const int body : state.members)
    if (const int first = linked_[static_cast<std::size_t>(body)]; first >= 0 && first != body)
      ties.emplace(first, body);
  const auto is_member = [&](int body) {
    return std::binary_search(state.members.begin(), state.members.end(), body);
  };
  for (const std::set<BodyPair>* pairs : {&state.lasting, &state.near})
    for (const BodyPair& pair : *pairs)
      if (is_member(pair.first) && is_member(pair.second)) ties.insert(pair);
  return {ties.begin(), ties.end()};
}

std::vector<std::vector<int>> LogicalProcesses::components_of(const ProcessState& state) const {
  Components components(state.members);
  for (const auto& [a, b] : ties_of(state)) components.join(a, b);
  return components.all();
}

std::vector<BegunFlight> LogicalProcesses::sort(const ProcessState& state) {
  std::vector<BegunFlight> flights;
  for (const std::vector<int>& members : components_of(state)) {
    const int first = members.front();
    const bool touches = std::any_of(
        state.lasting.begin(), state.lasting.end(),
        [&](const BodyPair& pair) { return pair.first == first || pair.second == first; });
    const bool flies = members.size() == 1 && linked_[static_cast<std::size_t>(first)] < 0 &&
                       !touches && !is_pushed(first, state.time);
    const int segment =
        flies ? -1
              : segments_.begin(members.size() == state.members.size() ? state
                                                                       : component(state, members));
    for (const int body : members) {
      const RigidBodyState& now = state.state_of(body);
      const Inertia& inertia = whole_.bodies[static_cast<std::size_t>(body)].inertia;
      Flight flight;
      flight.begin = state.time;
      flight.com_world = now.com_world;
      flight.velocity_world = inertia.inverse_mass * now.momentum_world;
      flight.world_from_body = now.world_from_body;
      flight.omega_body = inertia.inverse_inertia_body *
                          (now.world_from_body.conjugate() * now.angular_momentum_world);
      flight.segment = segment;
      flights.push_back({body, flight});
    }
  }
  std::sort(flights.begin(), flights.end(),
            [](const BegunFlight& a, const BegunFlight& b) { return a.body < b.body; });
  return flights;
}

ProcessState LogicalProcesses::component(const ProcessState& state,
                                         const std::vector<int>& members) const {
  const auto ours = [&](int body) {
    return std::binary_search(members.begin(), members.end(), body);
  };
  ProcessState part;
  part.time = state.time;
  part.members = members;
  for (const int body : members) part.states.push_back(state.state_of(body));
  for (const auto& [effect, memory] : state.remembered)
    for (const auto& [entry, numbers] : memory) {
      const std::vector<int> bodies =
          effects::all()[static_cast<std::size_t>(effect)]->bodies_of(whole_, entry);
      if (std::any_of(bodies.begin(), bodies.end(), ours))
        part.remembered[effect].emplace(entry, numbers);
    }
  const auto whole = [&](const BodyPair& pair) {
    const auto fits = [&](int body) {
      return ours(body) || whole_.bodies[static_cast<std::size_t>(body)].immovable();
    };
    return fits(pair.first) && fits(pair.second);
  };
  for (const auto& [pair, time] : state.met)
    if (whole(pair)) part.met.emplace(pair, time);
  for (const BodyPair& pair : state.lasting)
    if (whole(pair)) part.lasting.insert(pair);
  for (const BodyPair& pair : state.near)
    if (whole(pair)) part.near.insert(pair);
  for (const auto& [body, wrench] : state.pressing)
    if (ours(body)) part.pressing.emplace(body, wrench);
  return part;
}

}  // namespace tumble::engines
