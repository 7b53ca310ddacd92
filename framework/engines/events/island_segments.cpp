#include "framework/engines/events/island_segments.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/step_limits.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

ProcessState state_within(const ProcessStep& step, double t) {
  ProcessState state(step.from);
  if (t == step.from.time) return state;
  state.time = t;
  for (std::size_t k = 0; k < state.members.size(); ++k) state.states[k] = step.state_at(k, t);
  return state;
}

// The notes of a segment's end, of its last step. All that a step without length has noted is the
// end's: it lies in no stretch of time.
std::unique_ptr<RunWatch> notes_of_end(ProcessStep& step, double longest) {
  std::unique_ptr<RunWatch> noted = std::move(step.noted_at_end);
  if (!step.noted || !is_at_end(step.from.time, step.end, longest)) return noted;
  if (noted) step.noted->add(*noted);
  return std::move(step.noted);
}

}  // namespace

IslandSegments::IslandSegments(const World& whole, ShapeOf shape_of, const Laws& laws,
                               ProcessRules rules)
    : whole_(whole), entries_(whole), shape_of_(std::move(shape_of)), laws_(laws), rules_(rules) {
  if (!whole_.contact) return;
  for (int i = 0; i < static_cast<int>(whole_.bodies.size()); ++i)
    if (whole_.bodies[i].immovable() && whole_.bodies[i].collides) obstacles_.push_back(i);
}

// ---- Process worlds --------------------------------------------------------------------------

// A world is safe from deletion only while one thread uses its set of members: no world is deleted
// while threads share them.
IslandSegments::CachedWorld& IslandSegments::cached_world(const std::vector<int>& members,
                                                          int still) {
  CachedWorld* cached_world = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto known = worlds_.find({members, still});
    if (known != worlds_.end() && known->second.world) return known->second;
    if (worlds_.size() > clear_at_ && !is_shared_) {
      std::erase_if(worlds_, [this](const auto& old) {
        if (old.second.users > 0) return false;
        past_.add(old.second.counters);
        return true;
      });
      // where most worlds are in use, a scan at each new one would cost O(n^2)
      clear_at_ = std::max(kMostCachedWorlds, 2 * worlds_.size());
    }
    cached_world = &worlds_[{members, still}];
  }
  std::vector<int> immovable = obstacles_;
  if (still >= 0) immovable.push_back(still);
  cached_world->world = std::make_unique<ProcessWorld>(whole_, entries_, shape_of_, laws_, rules_,
                                                       cached_world->counters, members, immovable);
  return *cached_world;
}

void IslandSegments::add_counts_to(RunCounters& counters) const {
  counters.add(past_);
  counters.passages_begun += begun_;
  counters.passages_let_go += let_go_;
  for (const auto& [members, cached_world] : worlds_) counters.add(cached_world.counters);
}

ProcessWorld& IslandSegments::world_of(const std::vector<int>& members, int still) {
  return *cached_world(members, still).world;
}

// ---- Segments --------------------------------------------------------------------------------

int IslandSegments::begin(const ProcessState& state) {
  auto segment = std::make_unique<Segment>();
  segment->cached_world = &cached_world(state.members, -1);
  segment->start.emplace(state.without_memory());
  segment->front.emplace(state);
  segment->holders = static_cast<int>(state.members.size());
  const std::lock_guard lock(mutex_);
  ++segment->cached_world->users;
  ++begun_;
  const int number = segments_.take();
  segments_[number] = std::move(segment);
  return number;
}

void IslandSegments::release(int number) {
  const std::lock_guard lock(mutex_);
  Segment& segment = at(number);
  if (--segment.holders > 0) return;
  kept_ -= segment.steps.size();
  --segment.cached_world->users;
  ++let_go_;
  segments_.give_back(number);
}

// A step that begins within a rounding of that time is none of the run, and a note of a step's end
// counts where the end was reached: the response there, too, which was no event, since the segment
// has gone on.
void IslandSegments::stand(int number, double until) {
  Segment& segment = at(number);
  if (!segment.has_notes) return;
  const double slack = kNegligible * rules_.step;
  segment.has_notes = false;
  for (ProcessStep& step : segment.steps) {
    if (step.noted && !is_at_end(step.from.time, until, rules_.step)) {
      step.noted->drop_after(until + slack);
      count(std::move(step.noted));
    }
    if (step.noted_at_end && step.end <= until + slack) count(std::move(step.noted_at_end));
    segment.has_notes = segment.has_notes || step.noted || step.noted_at_end;
  }
}

// Threads count in any order: the sum is the same.
void IslandSegments::count(std::unique_ptr<RunWatch> noted) {
  const std::lock_guard lock(mutex_);
  past_.watch.add(*noted);
}

void IslandSegments::forget_before(double t) { forgotten_ = t; }

std::size_t IslandSegments::place(int segment, int body) const {
  const std::vector<int>& members = at(segment).start->members;
  return static_cast<std::size_t>(std::lower_bound(members.begin(), members.end(), body) -
                                  members.begin());
}

std::string IslandSegments::names(const std::vector<int>& members) const {
  return fmt::format("body '{}'{}", whole_.bodies[static_cast<std::size_t>(members.front())].name,
                     members.size() > 1 ? " and its island" : "");
}

ProcessWorld::Outcome IslandSegments::outcome_of_step(Segment& segment) const {
  // Steps end on a grid that all processes share, as frames do: bodies in contact match each
  // other's surfaces at the ends of steps.
  const double now = segment.front->time,
               due =
                   (std::floor((now + kNegligible * rules_.step) / rules_.step) + 1) * rules_.step;
  ProcessWorld::Outcome outcome =
      naming(fmt::format("at t = {:.6f} s, {}", now, names(segment.start->members)),
             [&] { return segment.cached_world->world->step(*segment.front, due); });
  segment.idle = outcome.step.end > now ? 0 : segment.idle + 1;
  if (segment.idle > kMostIdleSteps)
    throw StoppedRun(
        fmt::format("at t = {:.6f} s, {}: time stands still, its bodies collide again and again{}",
                    now, names(segment.start->members), room_beside_driven(whole_)));
  return outcome;
}

// What cannot be taken stops nothing yet: the segment stands at `state`. In place of the step one
// without length, which gives the state there, with the forces that led there.
void IslandSegments::stand_at(Segment& segment, ProcessState state, std::exception_ptr failure) {
  ProcessStep step{state.without_memory(), state.time, {}, {}};
  if (!segment.steps.empty()) step.forces = segment.steps.back().forces;
  keep(segment, std::move(step));
  segment.front.emplace(std::move(state));
  segment.failure = std::move(failure);
}

void IslandSegments::keep(Segment& segment, ProcessStep step) {
  const double forgotten = std::min(forgotten_, remembered_) - 2 * rules_.step;
  while (segment.steps.size() > 1 && segment.steps.front().end < forgotten) {
    // no rollback comes back to it
    ProcessStep& first = segment.steps.front();
    if (first.noted) count(std::move(first.noted));
    if (first.noted_at_end) count(std::move(first.noted_at_end));
    segment.steps.pop_front();
    --kept_;
  }
  segment.has_notes = segment.has_notes || step.noted || step.noted_at_end;
  segment.steps.push_back(std::move(step));
  ++kept_;
}

// The failure with the time and the names before it.
std::exception_ptr IslandSegments::named(const std::exception_ptr& failure, double t,
                                         const Segment& segment) const {
  try {
    naming(fmt::format("at t = {:.6f} s, {}", t, names(segment.start->members)),
           [&] { std::rethrow_exception(failure); });
  } catch (...) {
    return std::current_exception();
  }
  return failure;
}

void IslandSegments::take_step(Segment& segment) {
  std::optional<ProcessWorld::Outcome> taken;
  try {
    taken.emplace(outcome_of_step(segment));
  } catch (const OutOfTime&) {
    throw;  // whatever happens before it
  } catch (const std::exception&) {
    return stand_at(segment, std::move(*segment.front), std::current_exception());
  }
  ProcessWorld::Outcome& outcome = *taken;
  keep(segment, std::move(outcome.step));
  if (outcome.failure) {
    const ProcessStep& step = segment.steps.back();
    segment.fails_to_respond = true;
    return stand_at(segment, state_within(step, step.end),
                    named(outcome.failure, step.end, segment));
  }
  const bool is_one = segment.start->near.empty() || !falls_apart_(outcome.after);
  if (outcome.events.empty() && is_one) {
    segment.front.emplace(std::move(outcome.after));
  } else {
    ProcessStep& last = segment.steps.back();
    segment.end.emplace(SegmentEnd{last.end, std::move(outcome.after), std::move(outcome.events),
                                   notes_of_end(last, rules_.step)});
  }
}

// Computes steps until one ends after t: the state at the end of a step is the start of the next.
void IslandSegments::reach(int number, double t) {
  Segment& segment = at(number);
  while (!segment.end && !segment.failure && !(segment.front->time > t)) take_step(segment);
}

const SegmentEnd* IslandSegments::end_by(int number, double to) {
  reach(number, to);
  const Segment& segment = at(number);
  return segment.end && segment.end->time <= to ? &*segment.end : nullptr;
}

std::optional<double> IslandSegments::failed_by(int number, double to) {
  reach(number, to);
  const Segment& segment = at(number);
  if (!segment.failure || segment.front->time > to) return std::nullopt;
  return segment.front->time;
}

bool IslandSegments::fails_to_respond(int segment) const { return at(segment).fails_to_respond; }

void IslandSegments::raise(int segment) const {
  require(at(segment).failure != nullptr, "a segment without failure has none to raise");
  std::rethrow_exception(at(segment).failure);
}

const ProcessStep& IslandSegments::step_at(int number, double t) {
  reach(number, t);
  if (at(number).failure && !is_at_end(at(number).front->time, t, rules_.step)) raise(number);
  const std::deque<ProcessStep>& steps = at(number).steps;
  // by halves: "ordered" draws its frames at the next event, which may be the end of a long run
  const auto later =
      std::upper_bound(steps.begin(), steps.end(), t,
                       [](double time, const ProcessStep& step) { return time < step.from.time; });
  return later == steps.begin() ? *later : *std::prev(later);
}

double IslandSegments::step_end(int number, double t) {
  return failed_by(number, t) ? t : std::max(t, step_at(number, t).end);
}

RigidBodyState IslandSegments::body_state(int segment, int body, double t) {
  return step_at(segment, t).state_at(place(segment, body), t);
}

collision::MotionState IslandSegments::motion_at(int segment, int body, double t) {
  return step_at(segment, t)
      .motion_at(place(segment, body), t, whole_.bodies[static_cast<std::size_t>(body)].inertia);
}

ProcessState IslandSegments::state_at(int number, double t) {
  return state_within(step_at(number, t), t);
}

std::vector<RigidBodyState> IslandSegments::shown_at(int number, double t) {
  const ProcessStep& step = step_at(number, t);
  const ProcessState state = state_at(number, t);
  return t > step.from.time && t < step.end ? at(number).cached_world->world->shown(state).states
                                            : state.states;
}

collision::Motion IslandSegments::motion_in_step(int number, int body, double low) {
  const ProcessStep& step = step_at(number, low);
  const std::size_t member = place(number, body);
  const Inertia* inertia = &whole_.bodies[static_cast<std::size_t>(body)].inertia;
  return {[&step, member, inertia](double t) { return step.motion_at(member, t, *inertia); },
          step.paths.empty() ? collision::MotionBounds{} : step.paths[member].bounds()};
}

}  // namespace tumble::engines
