#include "framework/engines/timewarp/taught_timewarp.h"

#include <algorithm>

#include "framework/core/error.h"
#include "framework/core/numbers.h"
#include "framework/engines/events/ordered.h"
#include "framework/engines/timewarp/guarded_scheduling.h"
#include "framework/engines/timewarp/taught_run.h"

namespace tumble::engines {
namespace {

// with at most this number global virtual time is computed after every event; with more, once per
// as many events as processes
constexpr std::size_t kFewProcesses = 4;
// Events after which a run in which nothing becomes certain is stopped: at least so many, and in a
// large scene so many a check that may be due (of a pair, a group) and a process: in one step each
// of them has a few, and global virtual time rises when the last of them is done.
constexpr std::size_t kFewestEventsAtOneGvt = 20000, kEventsOfACheckAtOneGvt = 20;

/// Records the ordered reference. The sink of the run sees nothing of it but how far it is.
class ReferenceRecorder final : public TrajectorySink {
 public:
  explicit ReferenceRecorder(TrajectorySink& sink) : sink_(sink) {}
  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override {
    recorder_.begin(info, bodies);
  }
  void frame(const Frame& frame) override {
    recorder_.frame(frame);
    sink_.beat(frame.time);
  }
  void event(const Event& event) override { recorder_.event(event); }
  void end(const Counters& counters, const std::string& stopped_by) override {
    recorder_.end(counters, stopped_by);
  }
  const Trajectory& trajectory() const { return recorder_.trajectory(); }

 private:
  TrajectorySink& sink_;
  TrajectoryRecorder recorder_;
};

}  // namespace

TaughtTimewarp::TaughtTimewarp(const scene::Scene& scene, const Laws& laws,
                               const RunOptions& options, TrajectorySink& sink,
                               const Trajectory& reference)
    : watch_(sink, reference),
      run_(scene, laws, options, watch_),
      sink_(sink),
      decide_(guarded(laws.scheduling, laws.scheduling_source)),
      redraws_(options, scene.duration_s),
      queue_(decide_.comes_before) {
  for (int i = 0; i < world().size(); ++i) {
    processes_.emplace_back(world(), i);
    boxes_.push_back(world().can_move(i) ? Box{} : box_of_immovable(world(), i, run_.duration()));
    place_.push_back(static_cast<int>(times_.processes.size()));
    if (world().can_move(i))
      times_.processes.push_back(world().world().bodies[static_cast<std::size_t>(i)].name);
  }
}

void TaughtTimewarp::run() {
  std::string stopped_by;
  try {
    loop();
    stopped_by = watch_.missing();
    if (stopped_by.empty()) {
      stand(run_.duration());
      check_nothing_leaked();
    }
  } catch (const StoppedRun& stop) {
    stopped_by = stop.what();
  }
  if (!stopped_by.empty()) stand(run_.stands_until(stopped_by, committed_.time));
  if (stopped_by.empty() && !watch_.stop_of_reference().empty())
    stopped_by = "the ordered reference stopped: " + watch_.stop_of_reference();
  sink_.virtual_times(times_);
  if (stopped_by.empty())
    run_.counters.notices.push_back(
        fmt::format("committed trace: {} events, each the ordered reference's to the last bit",
                    watch_.events()));
  run_.end(stopped_by);
}

void TaughtTimewarp::stand(double until) {
  for (const int body : world().movers()) process(body).stand(until);
}

// ---- The loop ----------------------------------------------------------------------------------

void TaughtTimewarp::loop() {
  keep_group_checks();
  for (const EventStamp& callback : run_.callbacks()) expect_callback(callback);
  queue_.add({{0.0, kLastMicrostep, WorkKind::kRedraw, -1, -1}, kInfinity, {}});
  while (const std::optional<int> id = next_due()) {
    work_at(*id);
    if (++since_gvt_ > most_events_at_one_gvt())
      throw StoppedRun(
          fmt::format("{} events were executed and global virtual time still stands at {:.9g} s. "
                      "Likely: it is not the least of all local times and safe times, or a check "
                      "returns to the queue at a time at which it was already",
                      since_gvt_ - 1, gvt_));
    if (++since_asked_ >= (world().movers().size() <= kFewProcesses ? 1 : world().movers().size()))
      look_at_gvt(false);
  }
  look_at_gvt(true);
}

// The front of the queue within the run. Callbacks that have to wait stay behind all that need not;
// where nothing else is due, the one whose step fails first waits no longer.
std::optional<int> TaughtTimewarp::next_due() {
  std::vector<std::pair<double, int>> waiting;
  std::optional<int> next = queue_.pop();
  for (; next; next = queue_.pop()) {
    if (queue_.event(*next).stamp.time > run_.duration())
      queue_.park(*next);  // a rollback may restore it
    else if (const auto failure = waits_for(*next))
      waiting.emplace_back(*failure, *next);
    else
      break;
  }
  for (const auto& [failure, callback] : waiting) queue_.put(callback, queue_.event(callback));
  if (next || waiting.empty()) return next;
  const auto fails_first = [](const auto& x, const auto& y) { return x.first < y.first; };
  return std::min_element(waiting.begin(), waiting.end(), fails_first)->second;
}

// A callback on a body whose next step fails before the callback's time: an impact that no check
// has found yet may end that segment before the step. Once global virtual time is past the step,
// none can, and the callback raises the failure.
// @return the start of the first such step; nothing where the event need not wait [s]
std::optional<double> TaughtTimewarp::waits_for(int id) {
  const ScheduledEvent& event = queue_.event(id);
  if (event.stamp.kind != WorkKind::kCallback) return std::nullopt;
  std::optional<double> first;
  for (const int body : event.receivers) {
    const KeptState* state = process(body).at(event.stamp.time);
    if (state == nullptr || state->flight.segment < 0) continue;
    const auto failed =
        world().processes()->segments().failed_by(state->flight.segment, event.stamp.time);
    if (failed && *failed < event.stamp.time && gvt_ <= *failed && !(first && *first <= *failed))
      first = failed;
  }
  return first;
}

std::size_t TaughtTimewarp::most_events_at_one_gvt() const {
  return std::max(kFewestEventsAtOneGvt, kEventsOfACheckAtOneGvt * (pairs_.size() + groups_.size() +
                                                                    world().movers().size()));
}

void TaughtTimewarp::work_at(int id) {
  const ScheduledEvent event = queue_.event(id);
  if (event.stamp.kind == WorkKind::kRedraw) {
    for (const int body : world().movers()) integrate(body, event.stamp.time);
    return redraw(id);
  }
  for (const int body : event.receivers) integrate(body, event.stamp.time);
  if (event.stamp.kind == WorkKind::kCallback) return call(id);
  if (event.stamp.kind == WorkKind::kGroup) return check_group(id);
  check(id);
}

// Positions are copied when the frame is committed; here every process has reached its time.
void TaughtTimewarp::redraw(int id) {
  const double t = queue_.event(id).stamp.time;
  drawn_until_ = std::max(drawn_until_, t);
  queue_.remove(id);
  redraws_.take();
  if (t < run_.duration())
    queue_.add({{redraws_.next(), kLastMicrostep, WorkKind::kRedraw, -1, -1}, kInfinity, {}});
}

const KeptState& TaughtTimewarp::state_at(int body, double t) {
  if (const KeptState* state = process(body).at(t)) return *state;
  throw StoppedRun(fmt::format(
      "{} is needed at t = {:.9g} s, but its earliest state is that of {:.9g} s, with global "
      "virtual time at {:.9g} s. Likely: too many were purged (states_to_purge), a check is due at "
      "a time before it, or global virtual time is too late",
      name(body), t, process(body).states().front().time, gvt_));
}

// Every segment has been released with the last state that named it, or is released now; and every
// group check belongs to a current segment.
void TaughtTimewarp::check_nothing_leaked() {
  keep_group_checks();
  const auto checks = [&] {
    const std::vector<int> ids = queue_.ids();
    return static_cast<std::size_t>(std::count_if(ids.begin(), ids.end(), [&](int id) {
      return queue_.event(id).stamp.kind == WorkKind::kGroup;
    }));
  };
  require(checks() == groups_.size(), "no group check outlives its group");
  if (!world().processes()) return;
  for (const int body : world().movers()) process(body).drop_oldest(process(body).states().size());
  require(world().processes()->segments().alive() == 0, "no segment outlives its states");
}

// ---- A collision check -------------------------------------------------------------------------

void TaughtTimewarp::check(int id) {
  ScheduledEvent event = queue_.event(id);
  const int a = event.stamp.body_a, b = event.stamp.body_b;
  // stops the run where a state is missing
  for (const int body : event.receivers)
    state_at(body, std::min(event.safe_time, event.stamp.time));
  ++run_.counters.pair_checks;
  const double t = event.stamp.time;
  const std::optional<FoundImpact> found =
      find_impact(run_, process(a), process(b), event.safe_time, t);
  const auto flight_at = [&](int body) {
    return world().can_move(body) ? state_at(body, t).flight : world().first_flight(body);
  };
  CheckFinding finding = closeness(world(), a, flight_at(a), b, flight_at(b), t);
  if (found) {
    finding.contact = stamp_of(found->key);
    event.receivers = found->processes;
  }
  const CheckDecision decision = decide_.on_collision_check(event, finding, run_.step());
  if (decision.collides && !found)
    throw StoppedRun(
        fmt::format("on_collision_check says that {} and {} collide, but no impact was found in "
                    "[{:.9g}, {:.9g}] s",
                    name(a), name(b), event.safe_time, event.stamp.time));
  if (decision.collides) collide(id, *found, decision);
  const auto pair = pairs_.find({a, b});
  if (pair == pairs_.end() || pair->second != id) return;  // their boxes have separated
  event.safe_time = decision.next.safe_time;
  event.stamp.time = decision.next.stamp.time;
  event.receivers = bodies_that_move_with(world(), {{a, flight_of(a)}, {b, flight_of(b)}});
  put_check(id, event);
}

// ---- Integration and pairs ---------------------------------------------------------------------

void TaughtTimewarp::step_to(int body, double to) {
  const double from = process(body).local_time();
  process(body).integrate_to(to);
  ++run_.counters.steps;
  ++run_.counters.integrations;
  move(body, from, to);
  find_pairs(body, from);
}

// A pair whose boxes begin to overlap gets a check. It starts at the step that made them overlap:
// nothing is known from there, and beyond the other's swept box.
void TaughtTimewarp::find_pairs(int body, double from) {
  const Box own = box(body);
  for (int other = 0; other < world().size(); ++other) {
    const std::pair pair(std::min(body, other), std::max(body, other));
    if (other == body || !world().may_collide(body, other) || pairs_.contains(pair) ||
        !own.overlaps(box(other)))
      continue;
    ScheduledEvent check{
        {process(body).local_time(), 0, WorkKind::kCollision, pair.first, pair.second},
        std::min(from, local_time(other)),
        bodies_that_move_with(
            world(), {{pair.first, flight_of(pair.first)}, {pair.second, flight_of(pair.second)}})};
    check.stamp.time = due(check);
    pairs_[pair] = queue_.add(check);
    ++run_.counters.candidate_pairs;
  }
}

void TaughtTimewarp::drop_pairs_of(int body) {
  const Box own = box(body);
  std::erase_if(pairs_, [&](const auto& entry) {
    const auto& [pair, id] = entry;
    if (pair.first != body && pair.second != body) return false;
    if (own.overlaps(box(pair.first == body ? pair.second : pair.first))) return false;
    queue_.remove(id);
    return true;
  });
}

void run_taught_timewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                         TrajectorySink& sink) {
  ReferenceRecorder reference(sink);
  std::vector<TrajectoryBody> bodies;
  for (const scene::BodySpec& body : scene.bodies) bodies.push_back({body.name, body.immovable});
  reference.begin({}, bodies);
  RunOptions unseen = options;
  unseen.on_membership = nullptr;
  run_ordered(scene, laws, unseen, reference);
  TaughtTimewarp(scene, laws, options, sink, reference.trajectory()).run();
}

}  // namespace tumble::engines
