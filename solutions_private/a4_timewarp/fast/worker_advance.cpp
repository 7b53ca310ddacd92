// How far a process goes, and whom it may meet on the way. Part of Worker.
#include "framework/core/numbers.h"
#include "solutions_private/a4_timewarp/fast/worker.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/timewarp/flight_boxes.h"
#include "solutions_private/a4_timewarp/fast/territories.h"

namespace tumble::a4 {
namespace {

// Of what going on costs: a gap of two solids in checks of two balls, a flight's and a passage's step beside their checks. Roughly: they
// only balance territories.
constexpr std::uint64_t kGapChecks = 4;
constexpr double kStepChecks = 4, kPassageChecks = 300;
// A passage that has gone undisturbed for so long is likely to go on for a part of that: several of its steps at once are worked out while all
// that they need is in the nearest caches. A late impact then undoes at most that part of what it leaves standing.
constexpr double kTrust = 0.25;
constexpr int kMostStepsAtOnce = 8;

}  // namespace

// ---- A process goes on -------------------------------------------------------------------------------------------------

// Far enough that looking for partners pays, near enough that the box stays small: about the way to the next cell. Solids without closed
// forms go from window to window, as their impacts are searched, while anybody may be met.
double Worker::horizon_after(int body, const Flight& flight, double t) const {
  const FlightWorld& world = all_.world();
  if (flight.passage >= 0) {
    const double trusted = std::min(all_.run.duration(), t + kTrust * (t - flight.begin));
    double to = world.smooth_until(flight, t, kInfinity);
    for (int k = 1; k < kMostStepsAtOnce && to < trusted; ++k) {
      const double next = world.smooth_until(flight, to, kInfinity);
      if (!(next > to)) break;   // it ends there
      to = next;
    }
    return std::min(all_.run.duration(), to);
  }
  if (flight.is_resting || !world.collides(body)) return all_.run.duration();
  const double way = all_.lengths.way;
  const double speed = world.velocity(body, flight, t).norm() + std::sqrt(0.5 * world.gravity_world().norm() * way);
  const double far = std::min(all_.run.duration(), t + std::max(way / speed, 1e-9 * all_.run.step()));
  if (world.is_ball(body)) return far;
  const double near = std::min(all_.run.duration(), all_.run.impacts().window_end(t));
  return far > near && meets_nobody(body, flight, t, far) ? far : near;
}

// However it turns: what may be there is looked up, not searched.
bool Worker::meets_nobody(int body, const Flight& flight, double from, double to) const {
  const Box box = swept_box(body, std::min(from, global_virtual_time()), to);
  if (!is_alone() && !may_enter(box)) return false;
  for (const int plane : all_.planes)
    if (world().may_collide(body, plane) && all_.run.impacts().may_meet(body, flight, plane, all_.immovable(plane), from, to)) return false;
  bool is_nobody = true;
  for_each_in(all_.home[static_cast<std::size_t>(body)], box, [&](int other) { is_nobody = is_nobody && (other == body || !world().may_collide(body, other)); });
  return is_nobody;
}

// Around the body over [from, to], along all its flights there.
Box Worker::swept_box(int body, double from, double to) const {
  const FlightHistory& flights = history(body);
  Box box;
  for (std::size_t k = flights.at(from); k < flights.size(); ++k)
    box.take_in(engines::swept_box(all_.world(), body, flights[k], std::max(from, flights[k].begin), k + 1 < flights.size() ? flights[k + 1].begin : to));
  return box;
}

double Worker::global_virtual_time() const {
  if (all_.territories > 1) return all_.global_virtual_time;
  const engines::EventQueue<Due>& queue = all_.domains[kBorder].queue;
  return queue.empty() ? now : std::min(queue.front().key.time, now);
}

// All members of a process go on together; `body` is the first of them. Nobody goes beyond the window, nor out of the territory.
void Worker::advance(int body) {
  const Flight flight = history(body).back();
  const double from = process(body).horizon, gvt = global_virtual_time();
  double to = horizon_after(body, flight, from);
  // A ball's flight that one thread takes on is undone as a whole however short it is cut, and costs the same: the window is for others.
  const bool is_bounded = flight.passage >= 0 || all_.threads > 1;
  if (is_bounded && to > gvt + all_.window) to = std::max(from, gvt + all_.window);
  const auto own_end = all_.run.own_end(body, flight, to);
  if (own_end) to = own_end->time;
  const double swept_from = std::min(from, gvt);
  const auto members = flight.passage < 0 ? std::span<const int>(&body, 1) : std::span<const int>(world().all_processes().passages().members(flight.passage));
  boxes_.clear();
  for (const int member : members) {
    boxes_.push_back(swept_box(member, swept_from, to));
    if (!is_alone() && !may_enter(boxes_.back())) return look_again(body, kBorder);
  }
  found_.clear();
  if (own_end && own_end->time >= from) found_.push_back({*own_end, flight.serial, 0});
  for (std::size_t k = 0; k < members.size(); ++k) advance_member(members[k], history(members[k]).back(), from, to, boxes_[k]);
  // The process goes no farther than the first impact it knows of; what comes behind is looked for again if that one fails. Where that
  // impact is another's affair, its going on is too.
  for (const Due& due : found_) to = std::min(to, due.key.time);
  set_horizon(body, to);
  std::size_t home = all_.home[static_cast<std::size_t>(body)];
  for (const Due& due : found_) {
    if (due.key.time > to) continue;
    const std::size_t its_home = all_.territories > 1 ? all_.home_of(due.key) : kBorder;
    if (its_home != home) home = kBorder;
    push(due, its_home);
  }
  schedule(body, home);
}

// On one's way back nothing may be lost: what cannot go on here is taken on by the worker of the border, who then says why it cannot.
void Worker::advance_or_leave(int body) {
  if (is_alone()) return advance(body);
  try {
    advance(body);
  } catch (const engines::OutOfTime&) {
    throw;
  } catch (...) {
    look_again(body, kBorder);
  }
}

void Worker::push(const Due& due, std::size_t home) {
  if (is_alone() || home == home_) all_.domains[home].queue.push(due);
  else left.due.push_back(due);
}

void Worker::advance_member(int body, const Flight& flight, double from, double to, const Box& box) {
  ++counters.steps;
  ++counters.integrations;
  const std::uint64_t before = all_.burdens.empty() ? 0 : cost.pair_checks + kGapChecks * cost.narrow.gap_evaluations;
  enter_box(body, box);
  find_obstacles(body, flight, from, to);
  for_each_partner(body, box, [&](int other) { check(body, flight, from, to, other); });
  if (all_.burdens.empty()) return;
  const double checks = static_cast<double>(cost.pair_checks + kGapChecks * cost.narrow.gap_evaluations - before) + (flight.passage < 0 ? kStepChecks : kPassageChecks);
  all_.burdens[static_cast<std::size_t>(body)] += checks;
  burden += checks;
}

// ---- Whose the way is --------------------------------------------------------------------------------------------------------

// While others work: only within the territory, and where what is seen of the border stands still. Passages do not: to ask for one works it
// out.
bool Worker::may_enter(const Box& box) const {
  if (!holds(all_.domains[home_].territory, box)) return false;
  if (!world().processes()) return true;
  bool stands_still = true;
  all_.domains[kBorder].pairs.for_each_in(box, [&](int other) { stands_still = stands_still && (!world().can_move(other) || has_only_flown(other)); });
  return stands_still;
}

bool Worker::has_only_flown(int body) const {
  const FlightHistory& flights = history(body);
  for (std::size_t k = 0; k < flights.size(); ++k)
    if (flights[k].passage >= 0) return false;
  return true;
}

void Worker::enter_box(int body, const Box& box) {
  std::uint8_t& home = all_.home[static_cast<std::size_t>(body)];
  if (is_alone() && home != kBorder && !holds(all_.domains[home].territory, box)) {
    all_.domains[home].pairs.remove(body);
    home = kBorder;
  }
  all_.domains[home].pairs.set_box(body, box);
}

// What a body swept beyond where it has been sent back to is nobody's concern any more.
void Worker::shrink_box(int body) {
  const double to = process(body).horizon;
  Box box = swept_box(body, std::min(to, global_virtual_time()), to);
  if (!is_alone()) {   // not out of the territory, whatever rounding does: the box that it had holds all that it sweeps
    const Box& had = all_.domains[home_].pairs.box(body);
    box = {box.low.cwiseMax(had.low), box.high.cwiseMin(had.high)};
  }
  enter_box(body, box);
}

// The border's bodies may be met everywhere, a territory's in it and by the border's.
template <class Found>
void Worker::for_each_partner(int body, const Box& box, const Found& found) const {
  const std::size_t home = all_.home[static_cast<std::size_t>(body)];
  all_.domains[home].pairs.for_each_partner(body, found);
  for_each_elsewhere(home, box, found);
}

template <class Found>
void Worker::for_each_in(std::size_t home, const Box& box, const Found& found) const {
  all_.domains[home].pairs.for_each_in(box, found);
  for_each_elsewhere(home, box, found);
}

template <class Found>
void Worker::for_each_elsewhere(std::size_t home, const Box& box, const Found& found) const {
  if (home != kBorder) return all_.domains[kBorder].pairs.for_each_in(box, found);
  for (std::size_t k = 1; k < all_.domains.size(); ++k)
    if (all_.domains[k].territory.overlaps(box)) all_.domains[k].pairs.for_each_in(box, found);
}

// A body's local virtual time goes on, or back.
void Worker::move(int body, double t) {
  double& horizon = process(body).horizon;
  if (all_.is_recorded && t != horizon && moves.size() < engines::kMostMoves) {
    const auto until_end = [&](double time) { return std::min(time, all_.run.duration()); };
    const auto row = std::lower_bound(world().movers().begin(), world().movers().end(), body) - world().movers().begin();
    moves.push_back({static_cast<int>(row), until_end(horizon), until_end(t), until_end(global_virtual_time())});
  }
  horizon = t;
}

void Worker::set_horizon(int body, double t) {
  const Flight& flight = history(body).back();
  move(body, t);
  if (flight.passage >= 0)
    for (const int member : world().members(body, flight)) move(member, t);
}

void Worker::find_obstacles(int body, const Flight& flight, double from, double to) {
  Process& mine = process(body);
  if (all_.planes.empty() || flight.is_resting) return;
  if (!world().is_ball(body) || flight.passage >= 0) {
    for (const int plane : all_.planes) check(body, flight, from, to, plane);
    return;
  }
  // Of a ball's whole flight the first is known at once.
  if (mine.obstacle_serial != flight.serial) {
    mine.obstacle_serial = flight.serial;
    mine.obstacle_time = kInfinity;
    for (const int plane : all_.planes) {
      if (!world().may_collide(body, plane)) continue;
      if (!all_.run.impacts().has_closed_form(body, flight, plane, all_.immovable(plane))) {
        mine.obstacle_serial = kAfterAll;   // a moving plane: to be asked again
        check(body, flight, from, to, plane);
        continue;
      }
      const double time = all_.run.impacts().first_impact(body, flight, plane, all_.immovable(plane), from, to, cost);
      if (time < mine.obstacle_time) {
        mine.obstacle_time = time;
        mine.obstacle = plane;
      }
    }
  }
  if (mine.obstacle_time >= from && mine.obstacle_time <= to) offer(body, flight, mine.obstacle, all_.immovable(mine.obstacle), mine.obstacle_time, nullptr);
}

// Of every two bodies all impacts up to the lesser of their horizons are known: this makes it true for the later one.
void Worker::check(int body, const Flight& flight, double from, double to, int other) {
  if (!world().may_collide(body, other)) return;
  if (!world().can_move(other)) {
    const double time = all_.run.impacts().first_impact(body, flight, other, all_.immovable(other), from, to, cost);
    if (time >= from && time <= to) offer(body, flight, other, all_.immovable(other), time, nullptr);
    return;
  }
  if (flight.passage >= 0 && history(other).back().passage == flight.passage) {   // two of one process: asked about once
    if (other < body) return;
    const Flight& its = history(other).back();
    const double time = all_.run.impacts().first_impact(body, flight, other, its, from, to, cost);
    if (time >= from && time <= to) offer(body, flight, other, its, time, nullptr);
    return;
  }
  const double until = std::min(to, process(other).horizon);
  // The other will find what comes later. What comes at this very instant is found now: the other goes on only after all of its instant,
  // and this may have to come before some of that.
  if (until < from) return;
  const FlightHistory& flights = history(other);
  std::size_t first = flights.at(from);
  while (first > 0 && flights[first].begin == from) --first;   // all that it flew at this instant: an earlier blow may have to come before a later one
  for (std::size_t k = first; k < flights.size() && flights[k].begin <= until; ++k) {
    const Flight& its = flights[k];
    // A flight that ended at this instant is no motion beyond it: it would lead into what stopped it, where searching is dear.
    const double last = k + 1 < flights.size() && flights[k + 1].begin == from ? from : until;
    const double time = all_.run.impacts().first_impact(body, flight, other, its, std::max(from, its.begin), last, cost);
    if (time >= from && time <= last) offer(body, flight, other, its, time, k + 1 < flights.size() ? &flights[k + 1] : nullptr);
  }
}

void Worker::offer(int body, const Flight& flight, int other, const Flight& its, double time, const Flight* its_next) {
  const EventKey key = engines::key_of_impact(body, flight, other, its, time);
  if (its_next != nullptr && !(key < all_.begin_of(other, *its_next))) return;   // the other had been hit before
  const bool is_a = key.body_a == body;
  found_.push_back({key, is_a ? flight.serial : its.serial, is_a ? its.serial : flight.serial});
}

void Worker::schedule(int body, std::size_t home) {
  Process& going = process(body);
  push({{going.horizon, kAfterAll, EventClass::kAdvance, body, -1}, ++going.ticket, 0}, home);
}

// Of what was taken back the impacts are forgotten, those of the very instant, too: one of them may come before all that is known of it.
void Worker::look_again(int body, std::size_t home) {
  Process& going = process(body);
  push({{going.horizon, 0, EventClass::kLookAgain, body, -1}, ++going.ticket, 0}, home);
}

}  // namespace tumble::a4
