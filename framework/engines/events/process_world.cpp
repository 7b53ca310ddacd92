#include "framework/engines/events/process_world.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/step_limits.h"
#include "framework/engines/contact/contact_paths.h"
#include "framework/engines/contact/impact_law.h"
#include "framework/engines/contact/impact_response.h"

namespace tumble::engines {
namespace {

constexpr double kTogether = 2.0;         // steps
constexpr double kNear = 1e-6;            // of the sizes: pairs farther apart do not touch

std::vector<const collision::CollisionShape*> shapes_of(const WorldPart& part, const ShapeOf& shape_of) {
  std::vector<const collision::CollisionShape*> shapes;
  for (const int body : part.bodies) shapes.push_back(shape_of(body));
  return shapes;
}

}  // namespace

const RigidBodyState& ProcessState::state_of(int body) const { return states[static_cast<std::size_t>(std::lower_bound(members.begin(), members.end(), body) - members.begin())]; }

ProcessState ProcessState::without_memory() const { return {time, members, states, remembered, met, lasting, near, std::nullopt}; }

RigidBodyState ProcessStep::state_at(std::size_t member, double t) const { return t == from.time || paths.empty() ? from.states[member] : paths[member].at(t); }

collision::MotionState ProcessStep::motion_at(std::size_t member, double t, const Inertia& inertia) const {
  if (t != from.time && !paths.empty()) return paths[member].motion_at(t);
  const RigidBodyState& state = from.states[member];
  return {{state.com_world, state.world_from_body}, inertia.inverse_mass * state.momentum_world, omega_of(state, inertia)};
}

ProcessWorld::ProcessWorld(const World& whole, const EntriesByBody& entries, const ShapeOf& shape_of, const Laws& laws, ProcessRules rules, RunCounters& counters, const std::vector<int>& members, const std::vector<int>& still)
    : laws_(laws), rules_(rules), counters_(counters), members_(members), part_(part_of(whole, entries, members, still)), moving_(part_.world, laws, counters, shapes_of(part_, shape_of)),
      meetings_(moving_, laws, counters), impacts_(laws, {rules.rest_speed, kMicroInterval * rules.step}, counters) {
  if (!built::kContact || !moving_.world().contact) return;
  impacts_.use_contact_rules(rules.rest_speed, moving_.world().contact->impact_law);
  contacts_.emplace(moving_, laws, *moving_.world().contact, rules.rest_speed, counters, collector_);
}

int ProcessWorld::local(int body) const { return static_cast<int>(std::lower_bound(part_.bodies.begin(), part_.bodies.end(), body) - part_.bodies.begin()); }

// ---- A state in, a state out ---------------------------------------------------------------------------------------------

void ProcessWorld::load(const ProcessState& from, std::optional<ContactMemory> memory) {
  std::vector<RigidBodyState> states = moving_.states();
  for (std::size_t k = 0; k < members_.size(); ++k) states[static_cast<std::size_t>(part_.members[k])] = from.states[k];
  moving_.stand_at(from.time, states);
  if (!moving_.linked_groups().empty()) {
    const std::map<int, effects::Memory> remembered = renamed(from.remembered, false);
    for (LinkedBodies& group : moving_.linked_groups()) group.remember(remembered);
  }
  std::map<BodyPair, double> met;
  for (const auto& [pair, time] : from.met) met.emplace(local(pair), time);
  impacts_.remember(std::move(met));
  collector_.events.clear();
  if (!has_contacts()) return;
  if (memory) return contacts_->recall(std::move(*memory));
  contacts_->recall({});
  const std::uint64_t begun = counters_.contacts_begun;
  for (const BodyPair& pair : from.lasting) contacts_->begin(local(pair), {});   // it has begun before: what is said of it is not new
  counters_.contacts_begun = begun;
  collector_.events.clear();
}

// Entries of the part by their indices in the whole, or the other way round.
std::map<int, effects::Memory> ProcessWorld::renamed(const std::map<int, effects::Memory>& memory, bool to_whole) const {
  std::map<int, effects::Memory> renamed;
  for (const auto& [effect, entries] : memory) {
    const std::vector<int>& whole = part_.entries[static_cast<std::size_t>(effect)];
    for (const auto& [entry, numbers] : entries) {
      const auto local = std::lower_bound(whole.begin(), whole.end(), entry);
      if (to_whole) renamed[effect].emplace(whole[static_cast<std::size_t>(entry)], numbers);
      else if (local != whole.end() && *local == entry) renamed[effect].emplace(static_cast<int>(local - whole.begin()), numbers);
    }
  }
  return renamed;
}

// @return when the next steady force is switched [s]
double ProcessWorld::load_forces(const ProcessState& from) { return moving_.load_forces(renamed(from.remembered, false)); }

// What contacts remember goes with the state: the next load brings its own.
ProcessState ProcessWorld::save() {
  ProcessState state;
  state.time = moving_.time();
  state.members = members_;
  for (const int member : part_.members) state.states.push_back(moving_.state(member));
  save_controls(state);
  for (const auto& [pair, time] : impacts_.last_meetings())
    if (moving_.time() - time < rules_.step) state.met.emplace(whole(pair), time);
  if (!has_contacts()) return state;
  for (const BodyPair& pair : contacts_->lasting()) state.lasting.insert(whole(pair));
  if (moving_.world().contact->plastic_impacts == scene::PlasticImpacts::kInStep) note_near(state);
  state.contacts = contacts_->take_memory();
  return state;
}

// Where blows are dealt with in the step, bodies that come together again at once are no other group meanwhile: they would meet again and
// again, each time as if for the first.
void ProcessWorld::note_near(ProcessState& state) const {
  const auto speed = [&](int body) {
    const Body now = moving_.body_at_impact(body);
    return now.velocity_world.norm() + now.omega_world.norm() * moving_.shape(body).bounding_radius();
  };
  for (std::size_t i = 0; i < part_.members.size(); ++i)
    for (std::size_t j = i + 1; j < part_.members.size(); ++j) {
      const int a = part_.members[i], b = part_.members[j];
      if (std::min(moving_.world().bodies[a].restitution, moving_.world().bodies[b].restitution) > 0 || !moving_.may_collide(a, b)) continue;
      const double within = kTogether * rules_.step * (speed(a) + speed(b));
      if ((moving_.state(a).com_world - moving_.state(b).com_world).norm() > moving_.shape(a).bounding_radius() + moving_.shape(b).bounding_radius() + within) continue;
      if (meetings_.gap({a, b}).distance <= within) state.near.emplace(members_[i], members_[j]);
    }
}

void ProcessWorld::save_controls(ProcessState& state) const {
  std::map<int, effects::Memory> held = moving_.force_memory();
  for (const LinkedBodies& group : moving_.linked_groups())
    for (const auto& [effect, memory] : group.held()) held[effect].insert(memory.begin(), memory.end());
  state.remembered = renamed(held, true);
}

ProcessState ProcessWorld::at_start(const std::vector<RigidBodyState>& states) {
  ProcessState state;
  state.members = members_;
  for (const int body : members_) state.states.push_back(states[static_cast<std::size_t>(body)]);
  load(state);
  std::vector<RigidBodyState> all = moving_.states();
  for (LinkedBodies& group : moving_.linked_groups()) group.project(all, 0.0);
  moving_.stand_at(0.0, all);
  return save();
}

ProcessState ProcessWorld::on_constraints(const ProcessState& state) {
  load(state);
  for (LinkedBodies& group : moving_.linked_groups()) {
    std::vector<RigidBodyState> all = moving_.states();
    group.project_velocities(all, state.time);
    moving_.stand_at(state.time, all);
  }
  ProcessState after = state;   // and all else as it was
  after.states.clear();
  for (const int member : part_.members) after.states.push_back(moving_.state(member));
  return after;
}

ProcessState ProcessWorld::shown(const ProcessState& state) {
  load(state);
  std::vector<RigidBodyState> all = moving_.states();
  moving_.close_links(all, state.time);
  if (has_contacts()) contacts_->draw_apart(near_pairs(std::nullopt), all, state.time);
  ProcessState after = state;
  for (std::size_t k = 0; k < members_.size(); ++k) after.states[k] = all[static_cast<std::size_t>(part_.members[k])];
  return after;
}

std::vector<Event> ProcessWorld::take_events() {
  std::vector<Event> events = std::move(collector_.events);
  collector_.events.clear();
  for (Event& event : events) {
    event.body_a = whole(event.body_a);
    event.body_b = whole(event.body_b);
  }
  return events;
}

// ---- A step ----------------------------------------------------------------------------------------------------------------

// Every member goes along a smooth path, so that whoever asks where it is asks one thing.
void ProcessWorld::begin_step(double target) {
  moving_.begin_step(target);
  for (const int member : part_.members) {
    if (!moving_.smooth_path(member)) moving_.set_path(member, moving_.state(member), moving_.path_end(member));
    moving_.refuse_whirl(member);
  }
}

ProcessWorld::Outcome ProcessWorld::step(ProcessState& start, double due) {
  load(start, std::exchange(start.contacts, std::nullopt));
  const double next_look = moving_.look(), next_switch = load_forces(start);
  ProcessState from = start.without_memory();
  save_controls(from);
  ++counters_.steps;
  // As a world of all bodies does it (rd/retroactive.cpp), without sleep and pictures: free paths, contacts, the first impact, commit, response.
  begin_step(std::min({due, next_look, next_switch}));
  PairsOfStep pairs;
  if (has_contacts()) {
    pairs.searched = meetings_.candidates();
    const bool goes_on = keep_contacts(*contacts_, meetings_, pairs, [&](double earlier) {
      if (!collector_.events.empty()) return false;   // an impact at the very start
      begin_step(earlier);
      return true;
    });
    if (!goes_on) {
      ProcessState after = save();
      const double now = from.time;
      return {{std::move(from), now, {}, {}}, std::move(after), take_events()};
    }
  }
  const std::optional<Earliest> earliest = pairs.searched.empty() ? std::nullopt : meetings_.earliest(pairs.searched);
  const double reached = earliest ? earliest->time : moving_.target();
  ProcessStep step{std::move(from), reached, {}, forces()};
  if (reached > step.from.time)
    for (const int member : part_.members) step.paths.push_back(*moving_.smooth_path(member));
  moving_.commit(reached);
  require_numbers();
  if (has_contacts()) {
    take_back_overlaps(&*contacts_, meetings_, pairs);
    if (earliest) resolve(pairs.near.empty() ? pairs.searched : pairs.near, pairs.searched[earliest->pair], true);
  }
  if (!earliest) moving_.watch_links(reached - step.from.time);
  ProcessState after = save();
  return {std::move(step), std::move(after), take_events()};
}

std::vector<ContactPoint> ProcessWorld::forces() const {
  if (!has_contacts()) return {};
  std::vector<ContactPoint> forces = contacts_->forces();
  for (ContactPoint& point : forces) {
    point.body_a = whole(point.body_a);
    point.body_b = whole(point.body_b);
  }
  return forces;
}

void ProcessWorld::require_numbers() const {
  for (const int member : part_.members)
    if (!pack(moving_.state(member)).allFinite())
      throw StoppedRun(fmt::format("body {}: its state is not a number (integrator: {}; impulses: {})", name(member), laws_.integrator_source, laws_.impulse_source));
}

// ---- Impacts ---------------------------------------------------------------------------------------------------------------

std::vector<BodyPair> ProcessWorld::near_pairs(std::optional<BodyPair> trigger) const {
  std::vector<BodyPair> pairs;
  for (int a = 0; a < moving_.size(); ++a)
    for (int b = a + 1; b < moving_.size(); ++b) {
      if (trigger && BodyPair{a, b} == *trigger) {
        pairs.emplace_back(a, b);
        continue;
      }
      if (!moving_.world().contact || !moving_.may_collide(a, b)) continue;
      const double reach = moving_.shape(a).bounding_radius() + moving_.shape(b).bounding_radius();
      if ((moving_.state(a).com_world - moving_.state(b).com_world).norm() > reach * (1 + kNear)) continue;
      pairs.emplace_back(a, b);
    }
  return pairs;
}

ProcessWorld::Change ProcessWorld::begin_contacts(const ProcessState& state) {
  load(state);
  const std::vector<BodyPair> pairs = near_pairs(std::nullopt);
  meetings_.separate(pairs);
  contacts_->begin_where_touching(pairs);
  ProcessState after = save();
  return {std::move(after), take_events()};
}

ProcessWorld::Change ProcessWorld::collide(BodyPair pair, const ProcessState& state) {
  load(state);
  load_forces(state);
  const BodyPair trigger = local(pair);
  const std::vector<BodyPair> pairs = near_pairs(trigger);
  meetings_.separate(pairs);
  // A blow that is dealt with in the step it falls into is dealt with in the one that begins here, by all that the two then touch, friction
  // among it: so a world of all bodies does it, and of a blow struck alone and without friction something else would come.
  if (has_contacts() && contacts_->deals_in_step(trigger)) contacts_->begin(trigger, meetings_.gap(trigger));
  else resolve(pairs, trigger, false);
  require_numbers();
  if (collector_.events.empty()) {   // they met without coming nearer
    const collision::Gap gap = meetings_.gap(trigger);
    collector_.event({moving_.time(), EventKind::kCollision, trigger.first, trigger.second, 0.5 * (gap.point_a_world + gap.point_b_world), gap.normal_b_to_a_world, 0.0, 0.0, 0.0});
  }
  ProcessState after = save();
  return {std::move(after), take_events()};
}

// As a world of all bodies does it (rd/retroactive.cpp): everything that touches, and within the same impulses what rods and joints hold.
// What lies on something touches it: within a step that says which pairs were kept apart, at an instant all lasting contacts.
void ProcessWorld::resolve(const std::vector<BodyPair>& pairs, BodyPair trigger, bool is_in_step) {
  const StageTimer timer(counters_.impact_seconds);
  const TouchingPairs touching = touching_pairs(meetings_, pairs, trigger, [&](const BodyPair& pair) { return has_contacts() && contacts_->lasts(pair) && (!is_in_step || contacts_->keeps(pair)); });
  const Resolution resolution = impacts_.resolve(moving_, touching.all, touching.trigger);
  for (const Event& event : resolution.events) collector_.event(event);
  if (!resolution.settled) throw StoppedRun(told_left_approaching(laws_));
  if (!has_contacts()) return impacts_.push_apart(moving_, touching.all, resolution.micro_impacts);
  begin_slow_contacts(touching, resolution.events, impacts_, moving_.world(), *contacts_);
}

}  // namespace tumble::engines
