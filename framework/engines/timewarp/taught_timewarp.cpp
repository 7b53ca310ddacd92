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
// of them has a few, and global virtual time rises when the last of them is done. Right solutions
// needed at most 186, and 15 a check, in all scenes of the course and of the tests. Larger: a
// scheduler that makes no headway takes the judge's whole time, since an event of a heap takes it
// some milliseconds.
constexpr std::size_t kFewestEventsAtOneGvt = 2000, kEventsOfACheckAtOneGvt = 20;

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
      decide_(guarded(laws.scheduling, laws.scheduling_source)),
      redraws_(options, scene.duration_s),
      queue_(decide_.comes_before, run_.duration()),
      processes_(run_.world(), run_.duration()),
      pairs_(processes_, queue_, run_.counters),
      groups_(processes_, queue_),
      moves_(run_.world(), sink),
      motion_(run_, decide_, processes_, pairs_, moves_),
      commits_(run_, decide_, processes_) {}

void TaughtTimewarp::run() {
  std::string stopped_by;
  try {
    loop();
    stopped_by = watch_.missing();
    if (stopped_by.empty()) {
      processes_.stand(run_.duration());
      check_nothing_leaked();
    }
  } catch (const StoppedRun& stop) {
    stopped_by = stop.what();
  }
  if (!stopped_by.empty())
    processes_.stand(run_.stands_until(stopped_by, commits_.committed_until()));
  if (stopped_by.empty() && !watch_.stop_of_reference().empty())
    stopped_by = "the ordered reference stopped: " + watch_.stop_of_reference();
  moves_.end();
  if (stopped_by.empty())
    run_.counters.notices.push_back(
        fmt::format("committed trace: {} events, each the ordered reference's to the last bit",
                    watch_.events()));
  run_.end(stopped_by);
}

void TaughtTimewarp::loop() {
  const std::size_t movers = run_.world().movers().size();
  groups_.keep();
  for (const EventStamp& callback : run_.callbacks()) expect_callback(callback);
  queue_.add({{0.0, kLastMicrostep, WorkKind::kRedraw, -1, -1}, kInfinity, {}});
  while (const std::optional<int> id = next_due()) {
    execute(*id);
    const std::size_t most = std::max(
        kFewestEventsAtOneGvt, kEventsOfACheckAtOneGvt * (pairs_.size() + groups_.size() + movers));
    if (++since_gvt_ > most)
      throw StoppedRun(
          fmt::format("{} events were executed and global virtual time still stands at {:.9g} s. "
                      "Likely: it is not the least of all local times and safe times, a check "
                      "returns to the queue at a time at which it was already, or comes_before "
                      "lets a later event go first",
                      since_gvt_ - 1, processes_.global_virtual_time()));
    if (++since_asked_ >= (movers <= kFewProcesses ? 1 : movers)) look_at_gvt(false);
  }
  look_at_gvt(true);
}

// The front of the queue within the run. Callbacks on a body whose next step fails before them have
// to wait, and stay behind all that need not; where nothing else is due, the one whose step fails
// first waits no longer, and raises the failure.
std::optional<int> TaughtTimewarp::next_due() {
  std::vector<std::pair<double, int>> waiting;
  std::optional<int> next = queue_.pop();
  for (; next; next = queue_.pop()) {
    const ScheduledEvent& event = queue_.event(*next);
    if (event.stamp.time > run_.duration()) {
      queue_.park(*next);  // a rollback may restore it
      continue;
    }
    if (event.stamp.kind != WorkKind::kCallback) break;
    const auto failure = processes_.open_failure(event.receivers, event.stamp.time);
    if (!failure) break;
    waiting.emplace_back(*failure, *next);
  }
  for (const auto& [failure, callback] : waiting) queue_.put(callback, queue_.event(callback));
  if (next || waiting.empty()) return next;
  const auto fails_first = [](const auto& x, const auto& y) { return x.first < y.first; };
  return std::min_element(waiting.begin(), waiting.end(), fails_first)->second;
}

void TaughtTimewarp::look_at_gvt(bool is_over) {
  since_asked_ = 0;
  std::vector<ScheduledEvent> events;
  for (const int id : queue_.ids()) events.push_back(queue_.event(id));
  const double before = processes_.global_virtual_time(),
               gvt = is_over ? kInfinity
                             : decide_.global_virtual_time(processes_.local_times(), events);
  if (gvt < before)
    throw StoppedRun(fmt::format(
        "global virtual time falls from {:.9g} to {:.9g} s: it must never fall. Likely: it was too "
        "late before, because a local time or a safe time was left out",
        before, gvt));
  if (!(gvt > before)) return;
  processes_.raise_global_virtual_time(gvt);
  since_gvt_ = 0;
  moves_.raise(std::min(gvt, run_.duration()));
  commits_.commit();
  if (is_over)
    commits_.require_nothing_left();
  else
    motion_.purge();
}

// Every segment has been released with the last state that named it, or is released now; and every
// group check belongs to a current segment.
void TaughtTimewarp::check_nothing_leaked() {
  groups_.keep();
  const auto checks = [&] {
    const std::vector<int> ids = queue_.ids();
    return static_cast<std::size_t>(std::count_if(ids.begin(), ids.end(), [&](int id) {
      return queue_.event(id).stamp.kind == WorkKind::kGroup;
    }));
  };
  require(checks() == groups_.size(), "no group check outlives its group");
  const FlightWorld& world = run_.world();
  if (!world.processes()) return;
  for (const int body : world.movers())
    processes_[body].drop_oldest(processes_[body].states().size());
  require(world.processes()->segments().alive() == 0, "no segment outlives its states");
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
