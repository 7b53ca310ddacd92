#include "framework/engines/timewarp/taught_timewarp.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/dynamics/world.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/events/ordered.h"
#include "framework/engines/guarded_laws.h"
#include "framework/engines/timewarp/guarded_scheduling.h"
#include "framework/engines/timewarp/taught_process.h"
#include "framework/engines/timewarp/taught_queue.h"
#include "framework/engines/timewarp/taught_search.h"
#include "framework/engines/timewarp/trace_watch.h"

namespace tumble::engines {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewProcesses = 4;          // so few, and global virtual time is asked for after every event; else once an event and process
constexpr std::size_t kWorthPurging = 6;          // states of a body: fewer are not worth the question
constexpr std::size_t kMostMoves = 50000;         // of virtual times kept for the chart
constexpr std::size_t kMostEventsAtOneGvt = 20000;   // before a run is stopped in which nothing becomes certain

/// An impact that was worked at, until it is committed or taken back.
struct Executed {
  Effect effect;
  EventKey key;
  Event first;
  std::vector<Event> more;
  std::set<int> taken_back{};   // by which of its processes
};

class TaughtTimewarp {
 public:
  TaughtTimewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink, const Trajectory& reference)
      : watch_(sink, reference), run_(scene, laws, options, watch_), sink_(sink), decide_(guarded(laws.scheduling, laws.scheduling_source)), rate_(options.frame_rate_hz), queue_(decide_.comes_before) {
    for (int i = 0; i < world().size(); ++i) {
      processes_.emplace_back(world(), i);
      boxes_.push_back(world().can_move(i) ? Box{} : box_of_immovable(world(), i, run_.duration()));
      place_.push_back(static_cast<int>(times_.processes.size()));
      if (world().can_move(i)) times_.processes.push_back(world().world().bodies[static_cast<std::size_t>(i)].name);
    }
  }

  void run() {
    std::string stopped_by;
    try {
      loop();
      stopped_by = watch_.missing();
    } catch (const StoppedRun& stop) {
      stopped_by = stop.what();
    }
    sink_.virtual_times(times_);
    if (stopped_by.empty()) run_.counters.notices.push_back(fmt::format("committed trace: {} events, each the ordered reference's to the last bit", watch_.events()));
    run_.end(stopped_by);
  }

 private:
  const FlightWorld& world() const { return run_.world(); }
  TaughtProcess& process(int body) { return processes_[static_cast<std::size_t>(body)]; }
  const Flight& flight_of(int body) { return world().can_move(body) ? process(body).flight() : world().first_flight(body); }
  double local_time(int body) { return world().can_move(body) ? process(body).local_time() : kInfinity; }
  Box box(int body) { return world().can_move(body) ? process(body).swept() : boxes_[static_cast<std::size_t>(body)]; }
  std::string name(int body) const { return body < 0 || body >= world().size() ? fmt::format("body {}", body) : "'" + world().world().bodies[static_cast<std::size_t>(body)].name + "'"; }

  void loop();
  void work_at(int id);
  void redraw(int id);
  const KeptState& state_at(int body, double t);
  void check(int id);
  void collide(int id, const FoundImpact& found, const CheckDecision& decision);

  // The end of the run is a time to look, too: nothing in it goes unseen because the next look is due behind it.
  double due(const ScheduledEvent& check) const { return check.safe_time < run_.duration() ? std::min(check.stamp.time, run_.duration()) : check.stamp.time; }
  void put_check(int id, ScheduledEvent check) {
    check.stamp.time = due(check);
    queue_.put(id, check);
  }

  // By whole steps, past t where they do not fit: an optimist.
  void integrate(int body, double t) {
    while (process(body).local_time() < t) step_to(body, process(body).local_time() + run_.step());
  }
  void step_to(int body, double to);
  void find_pairs(int body, double from);
  void drop_pairs_of(int body);

  void roll_back(const std::vector<Rollback>& first, const std::string& why);
  void roll_back_one(const Rollback& rollback, const std::string& why);

  void look_at_gvt(bool is_over);
  void commit();
  void commit_impact(std::size_t which);
  void commit_frame();
  void purge();
  void move(int body, double from, double to) {
    if (times_.moves.size() < kMostMoves) times_.moves.push_back({place_[static_cast<std::size_t>(body)], from, to, gvt_});
  }

  TraceWatch watch_;
  FlightRun run_;
  TrajectorySink& sink_;
  Scheduling decide_;
  double rate_;
  std::vector<TaughtProcess> processes_;      // by body; those of walls are not used
  std::vector<Box> boxes_;                    // by body; of walls
  std::vector<int> place_;                    // by body: among the processes
  std::vector<std::uint32_t> next_serial_ = std::vector<std::uint32_t>(static_cast<std::size_t>(world().size()), 1);
  TaughtQueue queue_;
  std::map<std::pair<int, int>, int> pairs_;  // whose boxes overlap, to their check
  std::vector<Executed> executed_;
  VirtualTimes times_;
  double gvt_ = 0.0;                          // global virtual time [s]
  Stamp committed_{-1.0, 0, WorkKind::kCallback, -1, -1};   // the last that was
  double drawn_until_ = -1.0;                 // redraws up to this were at the front [s]
  long next_redraw_ = 0;
  std::size_t since_gvt_ = 0, since_asked_ = 0;   // events
};

// ---- The loop ----------------------------------------------------------------------------------------------------------

void TaughtTimewarp::loop() {
  queue_.add({{0.0, kLastGeneration, WorkKind::kRedraw, -1, -1}, kInfinity, {}});
  while (const std::optional<int> id = queue_.pop()) {
    if (queue_.event(*id).stamp.time > run_.duration()) {
      queue_.park(*id);   // a rollback may bring it back
      continue;
    }
    work_at(*id);
    if (++since_gvt_ > kMostEventsAtOneGvt)
      throw StoppedRun(fmt::format("{} events were worked at and global virtual time still stands at {:.9g} s. Likely: it is not the least of all local times and safe times, or a check comes back at a time at which it was", kMostEventsAtOneGvt, gvt_));
    if (++since_asked_ >= (world().movers().size() <= kFewProcesses ? 1 : world().movers().size())) look_at_gvt(false);
  }
  look_at_gvt(true);
}

void TaughtTimewarp::work_at(int id) {
  const ScheduledEvent event = queue_.event(id);
  if (event.stamp.kind == WorkKind::kRedraw) {
    for (const int body : world().movers()) integrate(body, event.stamp.time);
    return redraw(id);
  }
  for (const int body : event.receivers) integrate(body, event.stamp.time);
  check(id);
}

// Positions are copied when the frame is committed; here everybody has come to its time. The last redraw, at the end, shows nothing of its own.
void TaughtTimewarp::redraw(int id) {
  const double t = queue_.event(id).stamp.time;
  drawn_until_ = std::max(drawn_until_, t);
  queue_.remove(id);
  if (t >= run_.duration()) return;
  const double next = static_cast<double>(++next_redraw_) / rate_;
  queue_.add({{std::min(next, run_.duration()), kLastGeneration, WorkKind::kRedraw, -1, -1}, kInfinity, {}});
}

const KeptState& TaughtTimewarp::state_at(int body, double t) {
  if (const KeptState* state = process(body).at(t)) return *state;
  throw StoppedRun(fmt::format("{} is asked for at t = {:.9g} s, and its earliest state is that of {:.9g} s, with global virtual time at {:.9g} s. Likely: too many were purged (states_to_purge), a check is due at a time long gone, or global virtual time is too late",
                               name(body), t, process(body).states().front().time, gvt_));
}

// ---- A collision check -------------------------------------------------------------------------------------------------

void TaughtTimewarp::check(int id) {
  const ScheduledEvent event = queue_.event(id);
  const int a = event.stamp.body_a, b = event.stamp.body_b;
  for (const int body : event.receivers) state_at(body, std::min(event.safe_time, event.stamp.time));   // or the run stops here
  ++run_.counters.pair_checks;
  const double t = event.stamp.time;
  const std::optional<FoundImpact> found = find_impact(run_, process(a), process(b), event.safe_time, t);
  const auto flight_at = [&](int body) { return world().can_move(body) ? state_at(body, t).flight : world().first_flight(body); };
  CheckFinding finding = closeness(world(), a, flight_at(a), b, flight_at(b), t);
  if (found) finding.contact = stamp_of(found->key);
  const CheckDecision decision = decide_.on_collision_check(event, finding, run_.step());
  if (decision.collides && !found) throw StoppedRun(fmt::format("on_collision_check says that {} and {} collide, and nothing was found in [{:.9g}, {:.9g}] s", name(a), name(b), event.safe_time, event.stamp.time));
  if (decision.collides) collide(id, *found, decision);
  const auto pair = pairs_.find({a, b});
  if (pair == pairs_.end() || pair->second != id) return;   // their boxes parted meanwhile
  ScheduledEvent next = event;
  next.safe_time = decision.next.safe_time;
  next.stamp.time = decision.next.stamp.time;
  put_check(id, next);
}

void TaughtTimewarp::collide(int id, const FoundImpact& found, const CheckDecision& decision) {
  const EventKey& key = found.key;
  const int bodies[] = {key.body_a, key.body_b};
  queue_.park(id);   // it comes back as decided; the rollback must not put it in twice
  roll_back(decision.rollbacks, fmt::format("{} and {} meet at t = {:.9g} s", name(bodies[0]), name(bodies[1]), key.time));
  const std::uint32_t serials[] = {found.serial_a, found.serial_b};
  for (int side = 0; side < 2; ++side) {
    const int body = bodies[side];
    if (!world().can_move(body)) continue;
    if (process(body).flight().serial != serials[side] || process(body).local_time() > key.time)
      throw StoppedRun(fmt::format("{} and {} meet at t = {:.9g} s, and {} was not sent back there: it stands at {:.9g} s{}", name(bodies[0]), name(bodies[1]), key.time, name(body), process(body).local_time(),
                                   process(body).local_time() > key.time ? "" : ", on a flight that begins later"));
    if (process(body).local_time() < key.time) step_to(body, key.time);
  }
  Meeting meeting = run_.meet(key, flight_of(bodies[0]), flight_of(bodies[1]));
  Flight* after[] = {&meeting.a, &meeting.b};
  Executed executed{{stamp_of(key), {}}, key, meeting.first, meeting.more};
  for (int side = 0; side < 2; ++side) {
    const int body = bodies[side];
    if (!world().can_move(body)) continue;
    after[side]->serial = next_serial_[static_cast<std::size_t>(body)]++;
    process(body).begin(*after[side]);
    executed.effect.processes.push_back(body);
  }
  executed_.push_back(std::move(executed));
}

// ---- Integration and pairs ---------------------------------------------------------------------------------------------

void TaughtTimewarp::step_to(int body, double to) {
  const double from = process(body).local_time();
  process(body).integrate_to(to);
  ++run_.counters.steps;
  ++run_.counters.integrations;
  move(body, from, to);
  find_pairs(body, from);
}

// A pair whose boxes begin to overlap gets a check. Before the step that made them overlap, and beyond what the other has swept, nothing is known.
void TaughtTimewarp::find_pairs(int body, double from) {
  const Box own = box(body);
  for (int other = 0; other < world().size(); ++other) {
    const std::pair pair(std::min(body, other), std::max(body, other));
    if (other == body || !world().may_collide(body, other) || pairs_.contains(pair) || !own.overlaps(box(other))) continue;
    ScheduledEvent check{{process(body).local_time(), 0, WorkKind::kCollision, pair.first, pair.second}, std::min(from, local_time(other)), {}};
    for (const int receiver : {pair.first, pair.second})
      if (world().can_move(receiver)) check.receivers.push_back(receiver);
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

// ---- Rollback ----------------------------------------------------------------------------------------------------------

void TaughtTimewarp::roll_back(const std::vector<Rollback>& first, const std::string& why) {
  std::vector<Effect> effects;
  for (const Executed& executed : executed_) effects.push_back(executed.effect);
  const std::vector<Rollback> plan = decide_.plan_rollback(effects, first);
  for (const Rollback& rollback : plan) {
    if (rollback.body < 0 || rollback.body >= world().size() || !world().can_move(rollback.body))
      throw StoppedRun(fmt::format("{}, and plan_rollback sends back {}, which is no process", why, name(rollback.body)));
    roll_back_one(rollback, why);
  }
  std::erase_if(executed_, [&](const Executed& executed) {
    const bool is_gone = executed.taken_back.size() == executed.effect.processes.size();
    if (is_gone && executed.effect.processes.size() > 1) ++run_.counters.anti_messages;
    return is_gone;
  });
  for (const int id : queue_.ids()) {
    const ScheduledEvent event = queue_.event(id);
    const bool is_asked = std::any_of(plan.begin(), plan.end(), [&](const Rollback& rollback) { return std::find(event.receivers.begin(), event.receivers.end(), rollback.body) != event.receivers.end(); });
    if (!is_asked) continue;
    ScheduledEvent moved = event;
    const ScheduledEvent answer = decide_.after_rollback(event, plan);
    moved.stamp.time = answer.stamp.time;
    moved.safe_time = answer.safe_time;
    if (moved.stamp.time != event.stamp.time || moved.safe_time != event.safe_time) put_check(id, moved);
  }
  for (const Rollback& rollback : plan) drop_pairs_of(rollback.body);
}

void TaughtTimewarp::roll_back_one(const Rollback& rollback, const std::string& why) {
  TaughtProcess& back = process(rollback.body);
  const double from = back.local_time(), to = rollback.stamp.time;
  if (to > from) return;   // it has not come so far
  if (to < committed_.time)
    throw StoppedRun(fmt::format("{}: {} has to go back to t = {:.9g} s, and what happened up to {:.9g} s is committed. Likely: global virtual time is too late, or may_commit lets through what is not certain", why, name(rollback.body), to, committed_.time));
  const auto is_undone = [&](const KeptState& state) {
    if (state.time > to) return true;
    const Flight& flight = state.flight;
    if (flight.partner < 0) return false;   // the run's start
    if (flight.begin < to) return false;
    const Stamp begin{flight.begin, flight.generation, WorkKind::kCollision, std::min(rollback.body, flight.partner), std::max(rollback.body, flight.partner)};
    return !decide_.comes_before(begin, rollback.stamp);
  };
  std::size_t dropped = 0;
  while (!back.states().empty() && is_undone(back.states().back())) {
    if (back.states().size() == 1)
      throw StoppedRun(fmt::format("{}: {} has to go back to t = {:.9g} s, and no state from before is left: the earliest is that of {:.9g} s, with global virtual time at {:.9g} s. Likely: too many were purged (states_to_purge), or global virtual time is "
                                   "too late",
                                   why, name(rollback.body), to, back.states().front().time, gvt_));
    back.drop_latest();
    ++dropped;
  }
  if (back.local_time() < to) back.integrate_to(to);
  for (Executed& executed : executed_) {
    const auto& processes = executed.effect.processes;
    if (std::find(processes.begin(), processes.end(), rollback.body) != processes.end() && !decide_.comes_before(executed.effect.stamp, rollback.stamp)) executed.taken_back.insert(rollback.body);
  }
  if (dropped == 0) return;
  ++run_.counters.rollbacks;
  run_.counters.undone_integrations += dropped;
  move(rollback.body, from, to);
}

// ---- Global virtual time -----------------------------------------------------------------------------------------------

void TaughtTimewarp::look_at_gvt(bool is_over) {
  since_asked_ = 0;
  std::vector<LocalTime> local_times;
  std::vector<ScheduledEvent> events;
  for (const int body : world().movers()) local_times.push_back({body, process(body).local_time()});
  for (const int id : queue_.ids()) events.push_back(queue_.event(id));
  const double gvt = is_over ? kInfinity : decide_.global_virtual_time(local_times, events);
  if (gvt < gvt_) throw StoppedRun(fmt::format("global virtual time falls from {:.9g} to {:.9g} s: what is certain stays certain. Likely: it had been too late, for want of a local time or a safe time", gvt_, gvt));
  if (!(gvt > gvt_)) return;
  gvt_ = gvt;
  since_gvt_ = 0;
  if (!times_.moves.empty()) times_.moves.back().global_virtual_time_s = std::min(gvt_, run_.duration());
  commit();
  if (!is_over) return purge();
  const double left = run_.next_frame();
  if (!executed_.empty() || left <= run_.duration()) throw StoppedRun(fmt::format("the run is over, and may_commit refuses {} for good", executed_.empty() ? fmt::format("the frame at t = {:.9g} s", left) : "an impact"));
}

void TaughtTimewarp::commit() {
  // Insertion: bears an order that is none, and asks little where things came in order.
  for (std::size_t k = 1; k < executed_.size(); ++k)
    for (std::size_t i = k; i > 0 && decide_.comes_before(executed_[i].effect.stamp, executed_[i - 1].effect.stamp); --i) std::swap(executed_[i], executed_[i - 1]);
  for (;;) {
    const std::size_t first = 0;
    const Stamp frame{run_.next_frame(), kLastGeneration, WorkKind::kRedraw, -1, -1};
    const bool has_frame = frame.time <= drawn_until_, has_impact = first < executed_.size();
    if (!has_frame && !has_impact) return;
    const bool is_frame = has_frame && (!has_impact || decide_.comes_before(frame, executed_[first].effect.stamp));
    const Stamp next = is_frame ? frame : executed_[first].effect.stamp;
    if (!decide_.may_commit(next, gvt_)) return;
    naming(fmt::format("with global virtual time at {:.9g} s", gvt_), [&] {
      if (is_frame) commit_frame();
      else commit_impact(first);
    });
    committed_ = next;
  }
}

void TaughtTimewarp::commit_impact(std::size_t which) {
  const Executed executed = executed_[which];
  const std::string what = fmt::format("the impact of {} and {} at t = {:.9g} s", name(executed.key.body_a), name(executed.key.body_b), executed.key.time);
  if (!executed.taken_back.empty()) throw StoppedRun(fmt::format("{} was about to be committed, and only one of the two was sent back over it: the anti-message to the other is missing", what));
  const Stamp& last = committed_;
  const bool is_later = last.time < executed.key.time || (last.time == executed.key.time && last.kind == WorkKind::kCollision && EventKey{last.time, last.generation, EventClass::kCollision, last.body_a, last.body_b} < executed.key);
  if (!is_later) throw StoppedRun(fmt::format("{} was to be committed after something at {:.9g} s: comes_before has them out of their order, or it came too late, because global virtual time or may_commit had let through what was not certain", what, last.time));
  run_.commit(executed.key, executed.first, executed.more);
  executed_.erase(executed_.begin() + static_cast<std::ptrdiff_t>(which));
}

void TaughtTimewarp::commit_frame() {
  const double t = run_.next_frame();
  for (const int body : world().movers())
    if (process(body).at(t) == nullptr) throw StoppedRun(fmt::format("the frame at t = {:.9g} s cannot be drawn: {} has no state from so early any more. Likely: too many were purged (states_to_purge), or may_commit refused the frame too long", t, name(body)));
  run_.commit_frame([&](int body) -> const Flight& { return world().can_move(body) ? process(body).at(t)->flight : world().first_flight(body); });
}

void TaughtTimewarp::purge() {
  std::uint64_t kept = 0;
  for (const int body : world().movers()) {
    const std::size_t count = process(body).states().size();
    kept += count;
    if (count < kWorthPurging) continue;
    const std::size_t purged = decide_.states_to_purge(process(body).times(), gvt_);
    if (purged >= count) throw StoppedRun(fmt::format("states_to_purge gives away {} of the {} states of {}: none is left to go on from", purged, count, name(body)));
    if (purged == 0) continue;
    process(body).drop_oldest(purged);
    drop_pairs_of(body);
  }
  run_.counters.states_kept = std::max(run_.counters.states_kept, kept);
}

// Bodies that are pushed, hang together or lie on each other are processes of the fast scheduler's only.
void require_free_flight(const scene::Scene& scene, const RunOptions& options) {
  const World world = build_world(scene);
  const std::pair<bool, const char*> entries[] = {{!world.springs.empty(), "springs"}, {!world.rods.empty(), "rods"}, {!world.joints.empty(), "joints"}, {!world.drags.empty(), "drag"},
                                                  {!world.point_forces.empty(), "point forces"}, {world.contact.has_value(), "\"contact\""}, {!options.callbacks.empty(), "callbacks"}};
  for (const auto& [is_there, what] : entries)
    if (is_there)
      throw UserError(scene.file.empty() ? scene.name : scene.file.string(), fmt::format("it has {}, and a timewarp on the decisions of a module follows free flight and impacts only", what),
                      "Leave a4 out of --modules: then the fast scheduler runs it, if this tree has one; or take --engine rd.");
}

}  // namespace

void run_taught_timewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink) {
  require_free_flight(scene, options);
  TrajectoryRecorder reference;
  std::vector<TrajectoryBody> bodies;
  for (const scene::BodySpec& body : scene.bodies) bodies.push_back({body.name, body.immovable});
  reference.begin({}, bodies);
  run_ordered(scene, laws, options, reference);
  TaughtTimewarp(scene, laws, options, sink, reference.trajectory()).run();
}

}  // namespace tumble::engines
