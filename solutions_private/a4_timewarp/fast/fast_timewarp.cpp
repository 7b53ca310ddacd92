#include "solutions_private/a4_timewarp/fast/fast_timewarp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/guarded_laws.h"
#include "framework/engines/timewarp/active_pairs.h"
#include "framework/engines/timewarp/event_queue.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/engines/timewarp/flight_histories.h"
#include "solutions_private/a4_timewarp/fast/changes.h"
#include "solutions_private/a4_timewarp/fast/lengths.h"

namespace tumble::a4 {
namespace {

using engines::ActivePairs;
using engines::Box;
using engines::EventClass;
using engines::EventKey;
using engines::Flight;
using engines::FlightHistories;
using engines::FlightHistory;
using engines::FlightRun;
using engines::FlightWorld;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSlack = 1e-9;               // of lengths, on boxes: rounding hides nothing
constexpr std::size_t kCommitAfter = 512;     // events worked at before global virtual time is looked at again
constexpr std::uint32_t kAfterAll = std::numeric_limits<std::uint32_t>::max();   // generation of a process's going on: after the impacts of its instant

/// An event in the queue: an impact of two flights, or a process that goes on from its horizon.
struct Due {
  EventKey key;
  std::uint32_t serial_a, serial_b;   // of the flights; of a process: its ticket
};

struct Process {
  double horizon = 0.0;               // local virtual time [s]
  double obstacle_time = kInfinity;   // first impact of the flight with a half-space [s]
  std::uint32_t obstacle_serial = kAfterAll;   // of the flight that this was worked out for
  std::int32_t obstacle = -1;
  std::uint32_t ticket = 0;           // of the going on that stands in the queue; others are stale
  std::uint32_t next_serial = 1;
};

/// An impact that was worked at; committed when global virtual time has passed it, unless it was taken back.
struct Executed {
  EventKey key;
  std::uint32_t serial_a, serial_b;   // of the flights it began
  Event first;
  std::vector<Event> more;
  bool is_silent = false;             // nothing is said of it
};

class FastTimewarp {
 public:
  FastTimewarp(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record);
  void run();

 private:
  void loop();
  void check_nothing_leaked();
  void work_at(const Due& due);
  void fetch(const Due& due) const;
  Due next_legal();
  void advance(int body);
  void advance_member(int body, const Flight& flight, double from, double to);
  void collide(const Due& due);
  bool look_up(const Due& due, int side, std::size_t& place) const;
  void call(const Due& due);
  void expect_callback(const EventKey& key);
  void begin_flights(const Due& due, engines::Meeting meeting);
  int first_member(int body) const { return run_.world().first_member(body, histories_[body].back()); }
  void set_horizon(int body, double t);
  void move(int body, double t);
  void find_obstacles(int body, const Flight& flight, double from, double to);
  void check(int body, const Flight& flight, double from, double to, int other);
  void offer(int body, const Flight& flight, int other, const Flight& its, double time, const Flight* its_next);
  double horizon_after(int body, const Flight& flight, double t) const;
  Box swept_box(int body, double from, double to) const;
  void roll_back(int body, std::size_t keep);
  void begin_flight(int body, Flight flight, std::uint32_t serial);
  void forget(const Flight& flight);
  void schedule(int body);
  void commit_before(double t);
  bool still_stands(int body, std::uint32_t serial) const { return body < 0 || !run_.world().can_move(body) || histories_[body].find(serial) < histories_[body].size(); }
  const Flight& immovable(int body) const { return run_.world().first_flight(body); }
  EventKey begin_of(int body, const Flight& flight) const {
    if (flight.change >= 0) return changes_.key(flight.change);
    return {flight.begin, flight.generation, EventClass::kCollision, std::min(body, flight.partner), std::max(body, flight.partner)};
  }
  double global_virtual_time() const { return queue_.empty() ? kInfinity : std::min(queue_.front().key.time, now_); }

  FlightRun run_;
  engines::TimewarpTrial trial_;
  Random random_;
  FlightHistories histories_;
  Changes changes_;
  std::vector<Process, LargePages<Process>> processes_;     // by body
  std::vector<int> planes_;            // half-spaces
  Lengths lengths_;
  ActivePairs pairs_;
  engines::EventQueue<Due> queue_;
  std::vector<Executed> executed_;
  std::vector<bool> called_;           // by callback: executed, and not taken back
  std::vector<std::pair<int, std::size_t>> to_drop_;   // of roll_back, kept for its memory
  std::vector<Due> found_;             // of advance
  double now_ = kInfinity;             // of the event that is worked at: it is in the queue no more, but not done [s]
  double committed_ = 0.0;             // everything before is committed [s]
  std::size_t commit_at_ = kCommitAfter;   // size of executed_ at which global virtual time is looked at
  std::uint64_t worked_at_ = 0;
  VirtualTimes* record_;               // null: nobody wants to know
  double recorded_global_ = 0.0;       // [s]
};

FastTimewarp::FastTimewarp(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record)
    : run_(scene, laws, options, sink), trial_(options.trial), random_(options.trial.seed), histories_(static_cast<std::size_t>(run_.world().size())),
      processes_(static_cast<std::size_t>(run_.world().size())), lengths_(lengths_for(run_.world())), pairs_(run_.world().size(), lengths_.cell), queue_(bin_for(run_.world(), lengths_.way, run_.duration())), record_(record) {
  const FlightWorld& world = run_.world();
  if (record_)
    for (const int i : world.movers()) record_->processes.push_back(world.world().bodies[i].name);
  for (const int i : world.movers()) histories_.push(i, world.first_flight(i));
  for (const int i : world.obstacles()) {
    processes_[i].horizon = kInfinity;
    if (world.is_half_space(i)) {
      planes_.push_back(i);
      continue;
    }
    // An obstacle goes its prescribed way: a straight line, and no farther off it than its amplitude.
    const scene::PrescribedMotion& m = world.world().bodies[i].motion;
    const Vector3d start = world.first_flight(i).com_world, end = start + m.velocity_m_s * run_.duration();
    const Vector3d reach = m.amplitude_m.cwiseAbs() + Vector3d::Constant(kSlack * world.radius(i));
    Box box = engines::box_around(world.shape(i), world.first_flight(i).world_from_body);
    pairs_.set_box(i, {start.cwiseMin(end) + box.low - reach, start.cwiseMax(end) + box.high + reach});
  }
}

void FastTimewarp::run() {
  std::string stopped_by;
  try {
    loop();
    check_nothing_leaked();
  } catch (const engines::StoppedRun& stop) {
    stopped_by = stop.what();
  }
  run_.counters.states_kept = histories_.most_kept() + (run_.world().processes() ? run_.world().processes()->passages().most_kept() : 0);
  run_.end(stopped_by);
}

// Every flight that began has been dropped, forgotten or is among the last: what is left of passages and changes without one would never
// have been freed.
void FastTimewarp::check_nothing_leaked() {
  for (const int body : run_.world().movers())
    for (std::size_t k = 0; k < histories_[body].size(); ++k) forget(histories_[body][k]);
  require(run_.world().all_processes().passages().alive() == 0 && changes_.alive() == 0, "no passage or change outlives its flights");
}

void FastTimewarp::loop() {
  std::vector<int> order = run_.world().movers();
  if (trial_.shuffle)
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random_.below(i)]);
  now_ = 0.0;
  called_.assign(run_.callbacks().size(), false);
  for (const EventKey& callback : run_.callbacks()) expect_callback(callback);
  for (const int body : order)
    if (first_member(body) == body) advance(body);
  now_ = kInfinity;
  while (!queue_.empty() && queue_.front().key.time <= run_.duration()) {
    if (trial_.rollback_every > 0 && ++worked_at_ % static_cast<std::uint64_t>(trial_.rollback_every) == 0) {
      const int body = order[random_.below(order.size())];
      const double back_to = std::max(global_virtual_time(), std::min(processes_[body].horizon, run_.duration()) - random_.between(0.0, trial_.rollback_s));
      if (back_to < processes_[body].horizon) {
        roll_back(body, histories_[body].at(back_to) + 1);
        set_horizon(body, back_to);
        schedule(first_member(body));
      }
    }
    const Due due = trial_.disorder_s > 0 ? next_legal() : queue_.pop();
    now_ = due.key.time;
    if (!queue_.empty()) fetch(queue_.front());
    work_at(due);
    now_ = kInfinity;
    const double gvt = queue_.empty() ? kInfinity : queue_.front().key.time;
    if (executed_.size() >= commit_at_ || run_.next_frame() < gvt) {
      commit_before(std::min(gvt, run_.duration()));
      commit_at_ = executed_.size() + kCommitAfter;
    }
  }
  commit_before(kInfinity);
}

// What the next event will look at is on its way from memory while this one is worked at: in scenes of many bodies that is half the time.
void FastTimewarp::fetch(const Due& due) const {
  for (const int body : {due.key.body_a, due.key.body_b}) {
    if (body < 0) continue;
    __builtin_prefetch(&processes_[static_cast<std::size_t>(body)]);
    histories_.fetch(body);
    pairs_.fetch(body);
  }
}

// Any event that is not too far ahead of global virtual time may be taken: which, is drawn by lot.
Due FastTimewarp::next_legal() {
  const double latest = queue_.front().key.time + trial_.disorder_s;
  std::vector<Due> taken;
  const std::uint64_t most = 1 + random_.below(256);
  while (taken.size() < most && !queue_.empty() && queue_.front().key.time <= latest && queue_.front().key.time <= run_.duration()) taken.push_back(queue_.pop());
  const std::size_t chosen = random_.below(taken.size());
  for (std::size_t k = 0; k < taken.size(); ++k)
    if (k != chosen) queue_.push(taken[k]);
  return taken[chosen];
}

void FastTimewarp::work_at(const Due& due) {
  if (due.key.kind == EventClass::kCallback) return call(due);
  if (due.key.kind != EventClass::kAdvance) return collide(due);
  Process& process = processes_[due.key.body_a];
  if (process.ticket != due.serial_a || first_member(due.key.body_a) != due.key.body_a) return;
  if (process.horizon >= run_.duration()) set_horizon(due.key.body_a, kInfinity);   // nothing is left to find
  else advance(due.key.body_a);
}

// ---- A process goes on -------------------------------------------------------------------------------------------------

// Far enough that looking for partners pays, near enough that the box stays small: about the way to the next cell. Solids without closed
// forms go from window to window, as their impacts are searched.
double FastTimewarp::horizon_after(int body, const Flight& flight, double t) const {
  const FlightWorld& world = run_.world();
  if (flight.passage >= 0) return std::min(run_.duration(), world.smooth_until(flight, t, kInfinity));
  if (flight.is_resting || !world.collides(body)) return run_.duration();
  if (!world.is_ball(body)) return std::min(run_.duration(), run_.impacts().window_end(t));
  const double way = lengths_.way;
  const double speed = world.velocity(body, flight, t).norm() + std::sqrt(0.5 * world.gravity_world().norm() * way);
  return std::min(run_.duration(), t + std::max(way / speed, 1e-9 * run_.step()));
}

// Around the body over [from, to]: a parabola leaves the box of its ends by at most a s^2 / 8.
Box FastTimewarp::swept_box(int body, double from, double to) const {
  const FlightWorld& world = run_.world();
  const FlightHistory& history = histories_[body];
  Box box;
  for (std::size_t k = history.at(from); k < history.size(); ++k) {
    const Flight& flight = history[k];
    const double begin = std::max(from, flight.begin), end = k + 1 < history.size() ? history[k + 1].begin : to, s = end - begin;
    if (flight.passage >= 0) {
      Box way;
      world.take_in_way(body, flight, begin, end, way.low, way.high);
      const Vector3d margin = Vector3d::Constant(world.radius(body) * (1 + kSlack)) + kSlack * (way.high - way.low) + 1e-14 * (way.low.cwiseAbs() + way.high.cwiseAbs());
      box.take_in({way.low - margin, way.high + margin});
      continue;
    }
    const Vector3d first = world.position(body, flight, begin), last = world.position(body, flight, end);
    const Vector3d margin = world.acceleration(body, flight).cwiseAbs() * (s * s / 8) + Vector3d::Constant(world.radius(body) * (1 + kSlack)) + kSlack * (last - first).cwiseAbs() +
                            1e-14 * (first.cwiseAbs() + last.cwiseAbs());
    box.take_in({first.cwiseMin(last) - margin, first.cwiseMax(last) + margin});
  }
  return box;
}

// All members of a process go on together; `body` is the first of them.
void FastTimewarp::advance(int body) {
  const Flight flight = histories_[body].back();
  const double from = processes_[body].horizon;
  double to = horizon_after(body, flight, from);
  const auto own_end = run_.own_end(body, flight, to);
  if (own_end) to = own_end->time;
  found_.clear();
  if (own_end && own_end->time >= from) found_.push_back({*own_end, flight.serial, 0});
  if (flight.passage < 0) advance_member(body, flight, from, to);
  else
    for (const int member : run_.world().members(body, flight)) advance_member(member, histories_[member].back(), from, to);
  // The process goes no farther than the first impact it knows of; what comes behind is looked for again if that one fails.
  for (const Due& due : found_) to = std::min(to, due.key.time);
  set_horizon(body, to);
  for (const Due& due : found_)
    if (due.key.time <= to) queue_.push(due);
  schedule(body);
}

void FastTimewarp::advance_member(int body, const Flight& flight, double from, double to) {
  ++run_.counters.steps;
  ++run_.counters.integrations;
  pairs_.set_box(body, swept_box(body, std::min(from, global_virtual_time()), to));
  find_obstacles(body, flight, from, to);
  pairs_.for_each_partner(body, [&](int other) { check(body, flight, from, to, other); });
}

// A body's local virtual time goes on, or back.
void FastTimewarp::move(int body, double t) {
  double& horizon = processes_[body].horizon;
  if (record_ && t != horizon && record_->moves.size() < engines::kMostMoves) {
    const auto until_end = [&](double time) { return std::min(time, run_.duration()); };
    const auto row = std::lower_bound(run_.world().movers().begin(), run_.world().movers().end(), body) - run_.world().movers().begin();
    recorded_global_ = std::max(recorded_global_, until_end(global_virtual_time()));
    record_->moves.push_back({static_cast<int>(row), until_end(horizon), until_end(t), recorded_global_});
  }
  horizon = t;
}

void FastTimewarp::set_horizon(int body, double t) {
  const Flight& flight = histories_[body].back();
  move(body, t);
  if (flight.passage >= 0)
    for (const int member : run_.world().members(body, flight)) move(member, t);
}

void FastTimewarp::find_obstacles(int body, const Flight& flight, double from, double to) {
  Process& process = processes_[body];
  if (planes_.empty() || flight.is_resting) return;
  if (!run_.world().is_ball(body) || flight.passage >= 0) {
    for (const int plane : planes_) check(body, flight, from, to, plane);
    return;
  }
  // Of a ball's whole flight the first is known at once.
  if (process.obstacle_serial != flight.serial) {
    process.obstacle_serial = flight.serial;
    process.obstacle_time = kInfinity;
    for (const int plane : planes_) {
      if (!run_.world().may_collide(body, plane)) continue;
      if (!run_.impacts().has_closed_form(body, flight, plane, immovable(plane))) {
        process.obstacle_serial = kAfterAll;   // a moving plane: to be asked again
        check(body, flight, from, to, plane);
        continue;
      }
      const double time = run_.impacts().first_impact(body, flight, plane, immovable(plane), from, to, run_.cost);
      if (time < process.obstacle_time) {
        process.obstacle_time = time;
        process.obstacle = plane;
      }
    }
  }
  if (process.obstacle_time >= from && process.obstacle_time <= to) offer(body, flight, process.obstacle, immovable(process.obstacle), process.obstacle_time, nullptr);
}

// Of every two bodies all impacts up to the lesser of their horizons are known: this makes it true for the later one.
void FastTimewarp::check(int body, const Flight& flight, double from, double to, int other) {
  if (!run_.world().may_collide(body, other)) return;
  if (!run_.world().can_move(other)) {
    const double time = run_.impacts().first_impact(body, flight, other, immovable(other), from, to, run_.cost);
    if (time >= from && time <= to) offer(body, flight, other, immovable(other), time, nullptr);
    return;
  }
  if (flight.passage >= 0 && histories_[other].back().passage == flight.passage) {   // two of one process: asked about once
    if (other < body) return;
    const Flight& its = histories_[other].back();
    const double time = run_.impacts().first_impact(body, flight, other, its, from, to, run_.cost);
    if (time >= from && time <= to) offer(body, flight, other, its, time, nullptr);
    return;
  }
  const double until = std::min(to, processes_[other].horizon);
  if (!(until > from)) return;   // the other will find it
  const FlightHistory& history = histories_[other];
  for (std::size_t k = history.at(from); k < history.size() && history[k].begin <= until; ++k) {
    const Flight& its = history[k];
    const double time = run_.impacts().first_impact(body, flight, other, its, std::max(from, its.begin), until, run_.cost);
    if (time >= from && time <= until) offer(body, flight, other, its, time, k + 1 < history.size() ? &history[k + 1] : nullptr);
  }
}

void FastTimewarp::offer(int body, const Flight& flight, int other, const Flight& its, double time, const Flight* its_next) {
  const EventKey key = engines::key_of_impact(body, flight, other, its, time);
  if (its_next != nullptr && !(key < begin_of(other, *its_next))) return;   // the other had been hit before
  const bool is_a = key.body_a == body;
  found_.push_back({key, is_a ? flight.serial : its.serial, is_a ? its.serial : flight.serial});
}

void FastTimewarp::schedule(int body) {
  Process& process = processes_[body];
  queue_.push({{process.horizon, kAfterAll, EventClass::kAdvance, body, -1}, ++process.ticket, 0});
}

// ---- An impact ---------------------------------------------------------------------------------------------------------

// Whether the flight that an event speaks of is there and the event still to come on it.
bool FastTimewarp::look_up(const Due& due, int side, std::size_t& place) const {
  const int body = side == 0 ? due.key.body_a : due.key.body_b;
  if (body < 0 || !run_.world().can_move(body)) return true;
  // Rolled back since the event was found: on the way there something else may come first. It will be found again.
  if (processes_[body].horizon < due.key.time) return false;
  const FlightHistory& history = histories_[body];
  place = history.find(side == 0 ? due.serial_a : due.serial_b);
  if (place == history.size()) return false;   // taken back
  if (place + 1 == history.size()) return true;
  return due.key < begin_of(body, history[place + 1]);   // else hit before, or known twice
}

void FastTimewarp::collide(const Due& due) {
  const FlightWorld& world = run_.world();
  const int bodies[] = {due.key.body_a, due.key.body_b};
  const std::uint32_t serials[] = {due.serial_a, due.serial_b};
  std::size_t places[] = {0, 0};
  for (int side = 0; side < 2; ++side)
    if (!look_up(due, side, places[side])) return;
  for (int side = 0; side < 2; ++side) {
    const int body = bodies[side];
    if (body < 0 || !world.can_move(body)) continue;
    if (places[side] + 1 < histories_[body].size()) roll_back(body, places[side] + 1);
    if (processes_[body].horizon > due.key.time) ++run_.counters.undone_integrations;
  }
  const auto flight_of = [&](int side) -> const Flight& { return world.can_move(bodies[side]) ? histories_[bodies[side]][histories_[bodies[side]].find(serials[side])] : immovable(bodies[side]); };
  if (due.key.kind == EventClass::kProcess) return begin_flights(due, run_.end_of_passage(due.key, flight_of(0)));
  engines::Meeting meeting = run_.meet(due.key, flight_of(0), flight_of(1));
  if (!meeting.begun.empty()) return begin_flights(due, std::move(meeting));
  const std::uint32_t serial_a = world.can_move(bodies[0]) ? processes_[bodies[0]].next_serial++ : 0;
  const std::uint32_t serial_b = world.can_move(bodies[1]) ? processes_[bodies[1]].next_serial++ : 0;
  meeting.a.partner_serial = serial_b;
  meeting.b.partner_serial = serial_a;
  if (world.can_move(bodies[0])) begin_flight(bodies[0], meeting.a, serial_a);
  if (world.can_move(bodies[1])) begin_flight(bodies[1], meeting.b, serial_b);
  executed_.push_back({due.key, serial_a, serial_b, meeting.first, std::move(meeting.more)});
  for (const int body : bodies)
    if (world.can_move(body)) advance(body);
}

// ---- A callback --------------------------------------------------------------------------------------------------------

void FastTimewarp::expect_callback(const EventKey& key) {
  called_[key.generation] = false;
  queue_.push({key, 0, 0});
}

// Whatever its bodies have done beyond its time was done without it, and is taken back.
void FastTimewarp::call(const Due& due) {
  if (called_[due.key.generation]) return;
  bool is_early = false;
  for (const int body : run_.receivers(due.key))
    if (processes_[body].horizon < due.key.time) {   // taken out of its order: its bodies first have to come as far
      advance(first_member(body));
      is_early = true;
    }
  if (is_early) return queue_.push(due);
  for (const int body : run_.receivers(due.key)) {
    const FlightHistory& history = histories_[body];
    std::size_t place = history.size();
    while (place > 1 && due.key < begin_of(body, history[place - 1])) --place;
    if (place < history.size()) roll_back(body, place);
  }
  called_[due.key.generation] = true;
  begin_flights(due, run_.call(due.key, [this](int body) -> const Flight& { return histories_[body].back(); }));
}

// What an event does to processes: all that it begins is noted as one change, so that all of it can be taken back.
void FastTimewarp::begin_flights(const Due& due, engines::Meeting meeting) {
  const int change = changes_.add(due.key);
  std::uint32_t serials[] = {0, 0};
  for (engines::BegunFlight& begun : meeting.begun) {
    const std::uint32_t serial = processes_[begun.body].next_serial++;
    if (begun.body == due.key.body_a) serials[0] = serial;
    if (begun.body == due.key.body_b) serials[1] = serial;
    begun.flight.change = change;
    changes_.note(change, begun.body, serial);
    begin_flight(begun.body, begun.flight, serial);
  }
  executed_.push_back({due.key, serials[0], serials[1], meeting.first, std::move(meeting.more), meeting.is_silent});
  for (const engines::BegunFlight& begun : meeting.begun)
    if (first_member(begun.body) == begun.body) advance(begun.body);
}

void FastTimewarp::begin_flight(int body, Flight flight, std::uint32_t serial) {
  flight.serial = serial;
  histories_.purge(body, committed_, [&](const Flight& purged) { forget(purged); });
  histories_.push(body, flight);
  move(body, flight.begin);
}

void FastTimewarp::forget(const Flight& flight) {
  run_.world().release(flight);
  if (flight.change >= 0) changes_.release(flight.change);
}

// Drops the flights of a body from place `keep` on, and by anti-messages those of others that began with them, and so on.
void FastTimewarp::roll_back(int body, std::size_t keep) {
  to_drop_.assign(1, {body, keep});
  while (!to_drop_.empty()) {
    const auto [now, place] = to_drop_.back();
    to_drop_.pop_back();
    const FlightHistory& history = histories_[now];
    if (history.size() <= place) continue;
    ++run_.counters.rollbacks;
    while (history.size() > place) {
      const Flight dropped = history.back();
      histories_.pop(now);
      ++run_.counters.undone_integrations;
      move(now, std::min(processes_[now].horizon, dropped.begin));
      if (dropped.change >= 0) {
        if (const EventKey& key = changes_.key(dropped.change); key.kind == EventClass::kCallback && called_[key.generation]) expect_callback(key);
        for (const auto& [body, serial] : changes_.began(dropped.change)) {
          const std::size_t effect = histories_[body].find(serial);
          if (effect == histories_[body].size()) continue;
          ++run_.counters.anti_messages;
          to_drop_.emplace_back(body, effect);
        }
        forget(dropped);
        continue;
      }
      if (!run_.world().can_move(dropped.partner)) continue;
      const std::size_t effect = histories_[dropped.partner].find(dropped.partner_serial);
      if (effect == histories_[dropped.partner].size()) continue;   // taken back already
      ++run_.counters.anti_messages;
      to_drop_.emplace_back(dropped.partner, effect);
    }
    if (first_member(now) == now) schedule(now);
  }
}

// ---- Global virtual time -----------------------------------------------------------------------------------------------

void FastTimewarp::commit_before(double t) {
  const auto in_order = [](const Executed& x, const Executed& y) { return x.key < y.key; };
  if (!std::is_sorted(executed_.begin(), executed_.end(), in_order)) std::sort(executed_.begin(), executed_.end(), in_order);
  const auto draw_before = [&](double until) {
    while (run_.next_frame() < until) {
      const double time = run_.next_frame();
      run_.commit_frame([&](int body) -> const Flight& { return run_.world().can_move(body) ? histories_[body][histories_[body].at(time)] : immovable(body); });
    }
  };
  std::size_t done = 0;
  for (; done < executed_.size() && executed_[done].key.time < t; ++done) {
    const Executed& event = executed_[done];
    if (!still_stands(event.key.body_a, event.serial_a) || !still_stands(event.key.body_b, event.serial_b)) continue;   // taken back
    draw_before(event.key.time);
    if (event.is_silent) run_.pass(event.key);
    else run_.commit(event.key, event.first, event.more);
  }
  executed_.erase(executed_.begin(), executed_.begin() + static_cast<std::ptrdiff_t>(done));
  draw_before(t);
  committed_ = std::min(t, run_.duration());
  if (run_.world().processes()) run_.world().processes()->passages().forget_before(committed_);
}

}  // namespace

void run_fast_timewarp(const scene::Scene& scene, const Laws& laws, const engines::RunOptions& options, TrajectorySink& sink, VirtualTimes* record) {
  FastTimewarp(scene, laws, options, sink, record).run();
}

}  // namespace tumble::a4
