#include "framework/engines/events/flight_run.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "framework/collision/gap.h"
#include "framework/core/error.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/stepping/stability.h"
#include "framework/engines/base/step_limits.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {}  // namespace

FlightRun::FlightRun(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                     TrajectorySink& sink)
    : laws_(guarded(laws)),
      step_(options.step_s.value_or(scene.step_s)),
      duration_(options.duration_s.value_or(scene.duration_s)),
      frame_times_(options, scene.duration_s),
      world_(scene, options.engine, laws_, {step_, scene.rest_speed_m_s}),
      impacts_(world_, laws_.find_impact_time, step_),
      meetings_(world_, laws_, {scene.rest_speed_m_s, kMicroInterval * step_}),
      tied_impacts_(world_, laws_, {step_, scene.rest_speed_m_s}),
      sink_(sink),
      on_membership_(options.on_membership),
      callbacks_(options.callbacks),
      energy_watch_(scene.rest_speed_m_s, step_, false) {
  for (std::size_t k = 0; k < callbacks_.size(); ++k)
    callback_keys_.push_back({callbacks_[k].time, static_cast<std::uint32_t>(k),
                              StampKind::kCallback, callbacks_[k].bodies.front(), -1});
  if (scene.contact && scene.contact->impact_law == scene::ImpactLaw::kSimultaneous)
    counters.notices.emplace_back(
        "\"impact_law\": \"simultaneous\" takes impacts within an island together; those of bodies "
        "that fly freely act one after the other in this engine, also at one instant: --engine rd "
        "takes all together");
  if (!world_.processes()) return;
  refuse_unstable_steps(world_.world(), laws_, {step_, duration_}, place_of_step(scene, step_),
                        counters.notices);
  if (const auto step = report_unstable_links(world_.world(), LinkForces(world_.world()), laws_,
                                              {step_, duration_}, counters.notices))
    counters.watch.name_step(*step);
  links_ = std::make_unique<LinkMeasures>(world_, laws_);
  switches_ = force_switches(world_.world(), duration_);
  for (const Event& event : world_.start_events()) {
    sink_.event(event);
    energy_watch_.note(event);
  }
}

Discontinuity FlightRun::resolve_impact(const EventStamp& key, const Flight& f, const Flight& g,
                                        RunCounters& counters) const {
  if (f.segment >= 0 || g.segment >= 0 ||
      (world_.processes() && world_.processes()->holds_contacts()))
    return resolve_process_impact(key, f, g, counters);
  const auto subject = [&] {
    return fmt::format("bodies {} and {}", name(key.body_a), name(key.body_b));
  };
  if (key.microstep > most_microsteps(world_.size()))
    throw StoppedRun(fmt::format(
        "at t = {:.6f} s, {}: time stands still, impacts cause each other without end; {}{}",
        key.time, subject(), room_for_contact(world_.world()), room_beside_driven(world_.world())));
  try {
    ++counters.impacts;
    Discontinuity discontinuity = meetings_.resolve_impact(key, f, g);
    counters.impulses += discontinuity.impulse > 0 ? 1 + discontinuity.more.size() : 0;
    counters.integrations +=
        (world_.can_move(key.body_a) ? 1 : 0) + (world_.can_move(key.body_b) ? 1 : 0);
    return discontinuity;
  } catch (const OutOfTime&) {
    throw;
  } catch (const StoppedRun& stop) {
    throw StoppedRun(fmt::format("at t = {:.6f} s, {}: {}", key.time, subject(), stop.what()));
  }
}

namespace {

// Builds the discontinuity with all flights that an event begins.
Discontinuity finished(const EventStamp& key, std::vector<BegunFlight> begun,
                       const std::vector<Event>& events) {
  Discontinuity discontinuity;
  discontinuity.key = key;
  discontinuity.begun = std::move(begun);
  discontinuity.is_silent = events.empty();
  if (!events.empty()) {
    discontinuity.first = events.front();
    discontinuity.more.assign(events.begin() + 1, events.end());
  }
  for (BegunFlight& flight : discontinuity.begun) {
    flight.flight.microstep = key.microstep;
    flight.flight.partner = flight.body == key.body_a   ? key.body_b
                            : flight.body == key.body_b ? key.body_a
                                                        : -1;
  }
  for (const Event& event : events) discontinuity.impulse += event.impulse;
  return discontinuity;
}

}  // namespace

Discontinuity FlightRun::resolve_process_impact(const EventStamp& key, const Flight& f,
                                                const Flight& g, RunCounters& counters) const {
  const int a = key.body_a, b = key.body_b;
  if (key.microstep > most_microsteps(world_.size()))
    throw StoppedRun(
        fmt::format("at t = {:.6f} s, bodies {} and {}: time stands still, impacts cause each "
                    "other without end; {}{}",
                    key.time, name(a), name(b), room_for_contact(world_.world()),
                    room_beside_driven(world_.world())));
  LogicalProcesses& processes = *world_.processes();
  ++counters.impacts;
  const auto state_of = [&](int body, const Flight& flight) {
    return processes.state_of(
        body, flight, flight.segment < 0 ? world_.state(body, flight, key.time) : RigidBodyState{},
        key.time);
  };
  const bool one = f.segment >= 0 && f.segment == g.segment;
  const ProcessState state = !world_.can_move(a) ? state_of(b, g)
                             : !world_.can_move(b) || one
                                 ? state_of(a, f)
                                 : LogicalProcesses::together(state_of(a, f), state_of(b, g));
  const int still = processes.holds_contacts() ? -1
                    : !world_.can_move(a)      ? a
                    : !world_.can_move(b)      ? b
                                               : -1;
  ProcessWorld::Change change =
      naming(fmt::format("at t = {:.6f} s, bodies {} and {}", key.time, name(a), name(b)), [&] {
        return processes.segments().world_of(state.members, still).collide({a, b}, state);
      });
  Discontinuity discontinuity = finished(key, processes.sort(change.after), change.events);
  discontinuity.noted = std::move(change.noted);
  return discontinuity;
}

std::optional<EventStamp> FlightRun::own_end(int body, const Flight& flight, double to) const {
  if (flight.segment < 0 || world_.first_member(body, flight) != body) return std::nullopt;
  IslandSegments& segments = world_.processes()->segments();
  // impacts of the last instant are part of the run
  if (const auto failed = segments.failed_by(flight.segment, std::min(to, duration_));
      failed && (!is_at_end(*failed) || segments.fails_to_respond(flight.segment)))
    return EventStamp{*failed, std::numeric_limits<std::uint32_t>::max(), StampKind::kFault, body,
                      -1};
  if (!world_.processes()->holds_contacts()) return std::nullopt;
  const SegmentEnd* end = segments.end_by(flight.segment, to);
  if (!end) return std::nullopt;
  return EventStamp{end->time, end->time == flight.begin ? flight.microstep + 1 : 0,
                    StampKind::kProcess, body, -1};
}

Discontinuity FlightRun::end_of_segment(const EventStamp& key, const Flight& flight) const {
  if (key.kind == StampKind::kFault) world_.processes()->segments().raise(flight.segment);
  if (key.microstep > most_microsteps(world_.size()))
    throw StoppedRun(
        fmt::format("at t = {:.6f} s, body {}: time stands still among the bodies that touch it{}",
                    key.time, name(key.body_a), room_beside_driven(world_.world())));
  const SegmentEnd* end = world_.processes()->segments().end_by(flight.segment, key.time);
  require(end != nullptr, "a segment ends where own_end said");
  Discontinuity discontinuity = finished(key, world_.processes()->sort(end->after), end->events);
  // a copy: an engine with rollback may come to this end again
  if (end->noted) discontinuity.noted = std::make_unique<RunWatch>(*end->noted);
  return discontinuity;
}

Discontinuity FlightRun::call(const EventStamp& key, const FlightOf& flight_of) try {
  const Callback& callback = callbacks_[key.microstep];
  ++counters.callback_calls;
  LogicalProcesses& processes = world_.all_processes();
  std::vector<BegunFlight> begun;
  std::vector<Event> events;
  for (const int body : callback.bodies) {
    // already begun by an earlier body of its process
    if (std::any_of(begun.begin(), begun.end(),
                    [&](const BegunFlight& known) { return known.body == body; }))
      continue;
    const Flight& flight = flight_of(body);
    ProcessState state = processes.state_of(
        body, flight, flight.segment < 0 ? world_.state(body, flight, key.time) : RigidBodyState{},
        key.time);
    for (std::size_t k = 0; k < state.members.size(); ++k)
      if (std::binary_search(callback.bodies.begin(), callback.bodies.end(), state.members[k]))
        callback.act(state.members[k], state.states[k]);
    for (BegunFlight& next : processes.sort(processes.on_constraints(std::move(state))))
      begun.push_back(std::move(next));
  }
  for (const int body : callback.bodies)
    events.push_back({key.time, EventKind::kControl, body, -1,
                      world_.position(body, flight_of(body), key.time), Vector3d::UnitZ(), 0.0,
                      0.0});
  std::sort(begun.begin(), begun.end(),
            [](const BegunFlight& a, const BegunFlight& b) { return a.body < b.body; });
  return finished(key, std::move(begun), events);
} catch (const OutOfTime&) {
  throw;
} catch (const StoppedRun& stop) {
  throw StoppedRun(fmt::format("at t = {:.6f} s, {}", key.time, stop.what()));
}

// The times at which forces switch are known in advance, so their events are committed in time
// order by every engine.
void FlightRun::commit_switches(double until) {
  for (; switched_ < switches_.size() && switches_[switched_].time < until; ++switched_)
    sink_.event(switches_[switched_]);
}

void FlightRun::commit(const Discontinuity& discontinuity) {
  count(discontinuity.noted.get());
  if (!discontinuity.is_silent)
    return commit(discontinuity.key, discontinuity.first, discontinuity.more);
  pass(discontinuity.key);
}

void FlightRun::pass(const EventStamp& key) {
  if (!(last_ < key))
    throw PreconditionError(
        fmt::format("events are committed in their order: {} and {} at {:.17g} s ({}) after {} and "
                    "{} at {:.17g} s ({})",
                    name(key.body_a), name(key.body_b), key.time, key.microstep, name(last_.body_a),
                    name(last_.body_b), last_.time, last_.microstep));
  last_ = key;
}

void FlightRun::commit(const EventStamp& key, const Event& first, const std::vector<Event>& more) {
  pass(key);
  commit_switches(std::nextafter(key.time, 2 * key.time + 1));
  require_progress(key, first);
  sink_.event(first);
  energy_watch_.note(first);
  for (const Event& event : more) {
    sink_.event(event);
    energy_watch_.note(event);
  }
}

// Stops a run whose impacts accumulate: it would take hours.
void FlightRun::require_progress(const EventStamp& key, const Event& event) {
  if (event.kind != EventKind::kCollision) return;
  const double step = std::floor(key.time / step_);
  impacts_in_step_ = step == step_of_impacts_ ? impacts_in_step_ + 1 : 0;
  step_of_impacts_ = step;
  if (impacts_in_step_ <= most_impacts(world_.size())) return;
  stopped_at_ = key.time;
  throw StoppedRun(endless_impacts_message(
      key.time, fmt::format("bodies {} and {}", name(event.body_a), name(event.body_b)),
      world_.world()));
}

void FlightRun::count(const RunWatch* noted) {
  if (noted != nullptr) counters.watch.add(*noted);
}

void FlightRun::commit_frame(const FlightOf& flight_of) {
  const double t = next_frame();
  try {
    draw_frame(flight_of);
  } catch (const OutOfTime&) {
    throw;
  } catch (const StoppedRun&) {
    stopped_at_ = t;
    throw;
  }
}

void FlightRun::draw_frame(const FlightOf& flight_of) {
  const StageTimer timer(counters.record_seconds);
  commit_switches(next_frame());
  Frame frame = frame_of(world_, next_frame(), flight_of, states_);
  if (frame.smallest_gap < 0.0) note_overlaps(frame);
  if (links_) links_->measure(frame, flight_of);
  sink_.frame(frame);
  if (on_membership_) report_membership(frame.time, flight_of);
  frame_times_.take();
  if (!callbacks_.empty()) return;  // callbacks may add energy
  note_islands_in_contact(flight_of);
  const auto runaway =
      energy_watch_.look(frame.time, world_.world(), states_, frame.contacts,
                         [&](int body) { return pass_steps_of(body, frame.time, flight_of); });
  note_islands_in_contact(flight_of);  // until the next frame
  constexpr double kMostSteps = 256;   // between frames: what is kept for them is of some size
  if (world_.processes() && energy_watch_.has_damped() &&
      frame_times_.next() - frame.time <= kMostSteps * step_)
    world_.processes()->segments().remember_from(frame.time);
  if (!runaway) return;
  throw StoppedRun(
      runaway_message(frame.time, world_.world(), *runaway,
                      {states_, recorded_forces(world_.world(), frame), frame.contacts}, laws_));
}

// Between the ends of steps bodies are drawn along paths that lead from one to the next.
void FlightRun::note_overlaps(const Frame& frame) {
  const auto pose = [&](int k) {
    const BodyPose& its = frame.poses[static_cast<std::size_t>(k)];
    return collision::Pose{its.com_world, its.world_from_body};
  };
  for (int i = 0; i < world_.size(); ++i)
    for (int j = i + 1; j < world_.size(); ++j) {
      const double size = std::min(world_.radius(i), world_.radius(j));
      if (!(size > 0.0) || !(frame.smallest_gap < -kApart * size) || !world_.may_collide(i, j))
        continue;
      const double overlap = -collision::gap_distance(world_.shape(i), pose(i), world_.shape(j),
                                                      pose(j), nullptr, 0.0);
      RunWatch::Size told{overlap / size, kApart, frame.time, step_};
      told.meaning =
          "bodies stay apart: this frame, between the ends of steps, has them in each other by "
          "this part of the smaller one's radius";
      told.remedy = "--engine rd, which begins and ends a step of all bodies at each impact";
      counters.watch.note(RunWatch::Kind::kOverlapLeft, names_of(world_.world(), {i, j}), told);
    }
}

// A contact that lasts holds from a segment's start to its end, and one that begins or ends is an
// event, noted where it is committed. Where impacts are solved in steps, bodies also meet and part
// within one, and no event says so.
void FlightRun::note_islands_in_contact(const FlightOf& flight_of) {
  if (!world_.processes() || !world_.processes()->holds_contacts()) return;
  const bool in_steps = world_.world().contact->plastic_impacts == scene::PlasticImpacts::kInStep;
  for (int body = 0; body < world_.size(); ++body) {
    const int segment = flight_of(body).segment;
    if (segment < 0) continue;
    if (in_steps || !world_.processes()->segments().start(segment).lasting.empty())
      energy_watch_.note_touch(body, -1);
  }
}

// What dampers take goes up and down many times between two frames: it is looked at where each step
// begins.
// @return whether the steps since the last frame are known: nothing is said of an island that began
// since, or whose steps are forgotten
bool FlightRun::pass_steps_of(int body, double time, const FlightOf& flight_of) {
  const int segment = flight_of(body).segment;
  if (segment < 0) return false;
  IslandSegments& segments = world_.processes()->segments();
  const std::vector<int>& members = segments.members(segment);
  const double from = energy_watch_.last_look(), slack = kNegligible * step_;
  double known_from = kInfinity;
  std::vector<RigidBodyState> states = states_;
  segments.for_each_step(segment, from, time, [&](const ProcessStep& step) {
    known_from = std::min(known_from, step.from.time);
    if (step.from.time <= from + slack || step.from.time >= time - slack) return;
    for (std::size_t k = 0; k < members.size(); ++k)
      states[static_cast<std::size_t>(members[k])] = step.from.states[k];
    energy_watch_.pass(step.from.time, body, world_.world(), states);
  });
  return known_from <= from + slack;
}

void FlightRun::commit_frame_at(const EventStamp& fault, const FlightOf& flight_of) {
  // as far as rounding parts the two, and a segment that has failed still gives a state
  if (next_frame() > fault.time + std::min(frame_times_.slack(), kNegligible * step_)) return;
  const int segment = flight_of(fault.body_a).segment;
  if (segment >= 0 && world_.processes()->segments().fails_to_respond(segment)) return;
  try {
    commit_frame(flight_of);
  } catch (const OutOfTime&) {
    throw;
  } catch (const StoppedRun&) {
    stopped_at_ = kInfinity;  // the run stops for the fault
  }
}

void FlightRun::report_membership(double t, const FlightOf& flight_of) const {
  Membership membership{t, {}, {}};
  for (int i = 0; i < world_.size(); ++i) {
    const Flight& flight = flight_of(i);
    membership.segments.push_back(flight.segment);
    membership.first_members.push_back(world_.first_member(i, flight));
  }
  on_membership_(membership);
}

void FlightRun::end(const std::string& stopped_by) {
  if (stopped_by.empty()) commit_switches(std::nextafter(duration_, 2 * duration_ + 1));
  world_.all_processes().segments().add_counts_to(counters);
  counters.pair_checks += cost.pair_checks;
  counters.collision.gap_evaluations += cost.narrow.gap_evaluations;
  counters.collision.root_findings += cost.narrow.root_findings;
  energy_watch_.tell(world_.world(), laws_, counters);
  sink_.end(counters.named(), stopped_by);
}

}  // namespace tumble::engines
