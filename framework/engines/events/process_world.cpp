#include "framework/engines/events/process_world.h"

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tumble::engines {
namespace {

constexpr double kTogether = 2.0;  // steps

std::vector<const collision::CollisionShape*> shapes_of(const WorldPart& part,
                                                        const ShapeOf& shape_of) {
  std::vector<const collision::CollisionShape*> shapes;
  for (const int body : part.bodies) shapes.push_back(shape_of(body));
  return shapes;
}

// What is noted while it lives; what was noted before is put back at its end. What a step that
// throws has noted is dropped: there never was such a step.
class NotesOfOne {
 public:
  explicit NotesOfOne(RunWatch& watch) : watch_(watch), before_(std::exchange(watch, {})) {}
  ~NotesOfOne() { watch_ = std::move(before_); }
  NotesOfOne(const NotesOfOne&) = delete;
  NotesOfOne& operator=(const NotesOfOne&) = delete;

  // Moves the notes so far.
  void move_to(std::unique_ptr<RunWatch>& noted) {
    if (watch_.empty()) return;
    if (!noted) noted = std::make_unique<RunWatch>();
    noted->add(std::exchange(watch_, {}));
  }

 private:
  RunWatch& watch_;
  RunWatch before_;
};

}  // namespace

const RigidBodyState& ProcessState::state_of(int body) const {
  return states[static_cast<std::size_t>(std::lower_bound(members.begin(), members.end(), body) -
                                         members.begin())];
}

ProcessState ProcessState::without_memory() const {
  return {time, members, states, remembered, met, lasting, near, pressing, std::nullopt};
}

RigidBodyState ProcessStep::state_at(std::size_t member, double t) const {
  return t == from.time || paths.empty() ? from.states[member] : paths[member].at(t);
}

collision::MotionState ProcessStep::motion_at(std::size_t member, double t,
                                              const Inertia& inertia) const {
  if (t != from.time && !paths.empty()) return paths[member].motion_at(t);
  const RigidBodyState& state = from.states[member];
  return {{state.com_world, state.world_from_body},
          inertia.inverse_mass * state.momentum_world,
          omega_of(state, inertia)};
}

ProcessWorld::ProcessWorld(const World& whole, const EntriesByBody& entries,
                           const ShapeOf& shape_of, const Laws& laws, ProcessRules rules,
                           RunCounters& counters, const std::vector<int>& members,
                           const std::vector<int>& still)
    : rules_(rules),
      counters_(counters),
      members_(members),
      part_(part_of(whole, entries, members, still)),
      world_step_(part_.world, laws, {rules.step, rules.restitution_threshold, false}, counters,
                  collector_, shapes_of(part_, shape_of)),
      moving_(world_step_.moving()) {}

int ProcessWorld::local(int body) const {
  return static_cast<int>(std::lower_bound(part_.bodies.begin(), part_.bodies.end(), body) -
                          part_.bodies.begin());
}

// ---- Load and save a state -------------------------------------------------------------------

void ProcessWorld::load(const ProcessState& from, std::optional<ContactMemory> memory) {
  std::vector<RigidBodyState> states = moving_.states();
  for (std::size_t k = 0; k < members_.size(); ++k)
    states[static_cast<std::size_t>(part_.members[k])] = from.states[k];
  moving_.stand_at(from.time, states);
  if (!moving_.linked_groups().empty()) {
    const std::map<int, effects::Memory> remembered = renamed(from.remembered, false);
    for (LinkedBodies& group : moving_.linked_groups()) group.remember(remembered);
  }
  std::map<BodyPair, double> met;
  for (const auto& [pair, time] : from.met) met.emplace(local(pair), time);
  world_step_.impacts().remember(std::move(met));
  collector_.events.clear();
  if (!has_contacts()) return;
  if (memory) return world_step_.contacts().recall(std::move(*memory));
  world_step_.contacts().recall({});
  const std::uint64_t begun = counters_.contacts_begun;
  // it has begun before: no event
  for (const BodyPair& pair : from.lasting) world_step_.contacts().begin(local(pair), {});
  for (const auto& [body, wrench] : from.pressing)
    world_step_.contacts().expect(local(body), wrench);
  counters_.contacts_begun = begun;
  collector_.events.clear();
}

// Effect memory by the part's indices, from the whole world's, or the reverse.
std::map<int, effects::Memory> ProcessWorld::renamed(const std::map<int, effects::Memory>& memory,
                                                     bool to_whole) const {
  std::map<int, effects::Memory> renamed;
  for (const auto& [effect, entries] : memory) {
    const std::vector<int>& whole = part_.entries[static_cast<std::size_t>(effect)];
    for (const auto& [entry, numbers] : entries) {
      const auto local = std::lower_bound(whole.begin(), whole.end(), entry);
      if (to_whole)
        renamed[effect].emplace(whole[static_cast<std::size_t>(entry)], numbers);
      else if (local != whole.end() && *local == entry)
        renamed[effect].emplace(static_cast<int>(local - whole.begin()), numbers);
    }
  }
  return renamed;
}

// @return the time of the next switch of a steady force [s]
double ProcessWorld::load_forces(const ProcessState& from) {
  return moving_.load_forces(renamed(from.remembered, false));
}

// Moves the contact memory into the state: the next load brings its own.
ProcessState ProcessWorld::save() {
  ProcessState state;
  state.time = moving_.time();
  state.members = members_;
  for (const int member : part_.members) state.states.push_back(moving_.state(member));
  save_controls(state);
  for (const auto& [pair, time] : world_step_.impacts().last_impacts())
    if (moving_.time() - time < rules_.step) state.met.emplace(whole(pair), time);
  if (!has_contacts()) return state;
  for (const BodyPair& pair : world_step_.contacts().lasting()) state.lasting.insert(whole(pair));
  if (moving_.world().contact->plastic_impacts == scene::PlasticImpacts::kInStep) note_near(state);
  for (const auto& [body, wrench] : world_step_.contacts().pressing())
    state.pressing.emplace(whole(body), wrench);
  state.contacts = world_step_.contacts().take_memory();
  return state;
}

// Bodies about to touch again in the step stay in one island: splitting them would start every
// contact without its history.
void ProcessWorld::note_near(ProcessState& state) const {
  const auto speed = [&](int body) {
    const Body now = moving_.body_at_impact(body);
    return now.velocity_world.norm() +
           now.omega_world.norm() * moving_.shape(body).bounding_radius();
  };
  for (std::size_t i = 0; i < part_.members.size(); ++i)
    for (std::size_t j = i + 1; j < part_.members.size(); ++j) {
      const int a = part_.members[i], b = part_.members[j];
      if (std::min(moving_.world().bodies[a].restitution, moving_.world().bodies[b].restitution) >
              0 ||
          !moving_.may_collide(a, b))
        continue;
      const double within = kTogether * rules_.step * (speed(a) + speed(b));
      if ((moving_.state(a).com_world - moving_.state(b).com_world).norm() >
          moving_.shape(a).bounding_radius() + moving_.shape(b).bounding_radius() + within)
        continue;
      if (world_step_.impact_detection().gap({a, b}).distance <= within)
        state.near.emplace(members_[i], members_[j]);
    }
}

void ProcessWorld::save_controls(ProcessState& state) const {
  std::map<int, effects::Memory> held = moving_.force_memory();
  for (const LinkedBodies& group : moving_.linked_groups())
    for (const auto& [effect, memory] : group.held())
      held[effect].insert(memory.begin(), memory.end());
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
  ProcessState after = state;  // all else is unchanged
  after.states.clear();
  for (const int member : part_.members) after.states.push_back(moving_.state(member));
  return after;
}

ProcessState ProcessWorld::shown(const ProcessState& state) {
  load(state);
  std::vector<RigidBodyState> all = moving_.states();
  moving_.close_links(all, state.time);
  if (has_contacts())
    world_step_.contacts().remove_overlaps(near_pairs(std::nullopt), all, state.time);
  ProcessState after = state;
  for (std::size_t k = 0; k < members_.size(); ++k)
    after.states[k] = all[static_cast<std::size_t>(part_.members[k])];
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

// ---- A step ----------------------------------------------------------------------------------

// Every member follows a smooth path, so that every query of its motion reads the path.
void ProcessWorld::begin_step(double target) {
  moving_.begin_step(target);
  for (const int member : part_.members) {
    if (!moving_.smooth_path(member))
      moving_.set_path(member, moving_.state(member), moving_.path_end(member));
    moving_.refuse_fast_turning(member);
  }
}

// Beside what a world of all bodies does in a step: the paths are kept, and an impact at the very
// start is a step's end.
struct ProcessWorld::Stages final : StepStages {
  explicit Stages(ProcessWorld& of, ProcessStep* taken = nullptr) : world(of), step(taken) {}
  void begin(double target) override { world.begin_step(target); }
  bool begin_again(double target) override {
    if (!world.collector_.events.empty()) return false;
    world.begin_step(target);
    return true;
  }
  void before_commit(double reached) override {
    step->end = reached;
    step->forces = world.forces();
    if (reached > step->from.time)
      for (const int member : world.part_.members)
        step->paths.push_back(*world.moving_.smooth_path(member));
  }
  void impact(const Event& event) override { world.collector_.event(event); }

  ProcessWorld& world;
  ProcessStep* step;  // the one under way
};

ProcessWorld::Outcome ProcessWorld::step(ProcessState& start, double due) {
  NotesOfOne notes(counters_.watch);
  load(start, std::exchange(start.contacts, std::nullopt));
  const double next_look = moving_.look(), next_switch = load_forces(start);
  ProcessStep step{start.without_memory(), start.time, {}, {}};
  save_controls(step.from);
  Stages stages(*this, &step);
  const WorldStep::Taken taken =
      world_step_.take(first_of({due, next_look, next_switch}, rules_.step), stages);
  notes.move_to(step.noted);
  if (taken.impact) {
    try {
      world_step_.respond(taken.around(), *taken.impact, true, stages);
    } catch (const OutOfTime&) {
      throw;
    } catch (const std::exception&) {
      return {std::move(step), {}, {}, std::current_exception()};
    }
    notes.move_to(step.noted_at_end);
  }
  ProcessState after = save();
  return {std::move(step), std::move(after), take_events()};
}

std::vector<ContactPoint> ProcessWorld::forces() const {
  if (!has_contacts()) return {};
  std::vector<ContactPoint> forces = world_step_.contacts().forces();
  for (ContactPoint& point : forces) {
    point.body_a = whole(point.body_a);
    point.body_b = whole(point.body_b);
  }
  return forces;
}

// ---- Impacts ---------------------------------------------------------------------------------

std::vector<BodyPair> ProcessWorld::near_pairs(std::optional<BodyPair> trigger) const {
  std::vector<BodyPair> pairs;
  for (int a = 0; a < moving_.size(); ++a)
    for (int b = a + 1; b < moving_.size(); ++b) {
      if (trigger && BodyPair{a, b} == *trigger) {
        pairs.emplace_back(a, b);
        continue;
      }
      if (!moving_.may_collide(a, b)) continue;
      const double reach = moving_.shape(a).bounding_radius() + moving_.shape(b).bounding_radius();
      if ((moving_.state(a).com_world - moving_.state(b).com_world).norm() >
          reach * (1 + kSixDigits))
        continue;
      pairs.emplace_back(a, b);
    }
  return pairs;
}

ProcessWorld::Change ProcessWorld::begin_contacts(const ProcessState& state) {
  load(state);
  const std::vector<BodyPair> pairs = near_pairs(std::nullopt);
  world_step_.impact_detection().separate(pairs);
  world_step_.contacts().begin_where_touching(pairs);
  ProcessState after = save();
  return {std::move(after), take_events()};
}

ProcessWorld::Change ProcessWorld::collide(BodyPair pair, const ProcessState& state) {
  NotesOfOne notes(counters_.watch);
  load(state);
  load_forces(state);
  const BodyPair trigger = local(pair);
  // The step ends here, as in a world of all bodies: contacts that have opened in it take no part.
  if (has_contacts()) world_step_.contacts().end_where_apart();
  const std::size_t ended = collector_.events.size();
  const std::vector<BodyPair> pairs =
      has_contacts() ? near_pairs(trigger) : std::vector<BodyPair>{trigger};
  world_step_.impact_detection().separate(pairs);
  // An impact that is resolved within its step is resolved in the step that begins here, together
  // with all contacts of the two bodies and friction, as in a world of all bodies. Resolved alone
  // and without friction it would have another result.
  if (has_contacts() && world_step_.contacts().deals_in_step(trigger)) {
    world_step_.contacts().begin(trigger, world_step_.impact_detection().gap(trigger));
  } else {
    Stages stages(*this);
    world_step_.respond(pairs, trigger, false, stages);
  }
  world_step_.require_numbers();
  if (collector_.events.size() == ended) {  // they touched without approach
    const collision::Gap gap = world_step_.impact_detection().gap(trigger);
    collector_.event({moving_.time(), EventKind::kCollision, trigger.first, trigger.second,
                      0.5 * (gap.point_a_world + gap.point_b_world), gap.normal_b_to_a_world, 0.0,
                      0.0, 0.0});
  }
  Change change{save(), take_events()};
  notes.move_to(change.noted);
  return change;
}

void ProcessWorld::watch_order(BodyPair pair, const ProcessState& state) {
  load(state);
  const BodyPair trigger = local(pair);
  if (has_contacts() && world_step_.contacts().deals_in_step(trigger)) return;
  Stages stages(*this);
  world_step_.respond(near_pairs(trigger), trigger, false, stages);
}

}  // namespace tumble::engines
