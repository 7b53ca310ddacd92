// The advance of a process, and its partners on the way. Part of Worker.
#include "framework/core/numbers.h"
#include "solutions_private/a4_timewarp/fast/worker.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/timewarp/flight_boxes.h"
#include "solutions_private/a4_timewarp/fast/partition.h"

namespace tumble::a4 {
namespace {

// Cost of an advance: a gap of two solids, a step of a flight and of a segment, in units of a check
// of two balls. Rough values: they only balance regions.
constexpr std::uint64_t kGapChecks = 4;
constexpr double kStepChecks = 4, kSegmentChecks = 300;
// A segment that has lasted for long without an event is likely to last for a fraction of that
// time: several of its steps are computed at once while its data is in the nearest caches. A late
// impact then rolls back at most that fraction.
constexpr double kTrust = 0.25;
constexpr int kMostStepsAtOnce = 8;

}  // namespace

// ---- Advance ---------------------------------------------------------------------------------

// The new horizon: far enough that the search for partners is worth its cost, near enough that the
// box stays small: about the distance to the next cell. Solids without closed forms advance from
// window to window, as their impacts are searched, where they may meet a body.
double Worker::horizon_after(int body, const Flight& flight, double t) const {
  const FlightWorld& world = all_.world();
  if (flight.segment >= 0) {
    const double trusted = std::min(all_.run.duration(), t + kTrust * (t - flight.begin));
    double to = world.smooth_until(flight, t, kInfinity);
    for (int k = 1; k < kMostStepsAtOnce && to < trusted; ++k) {
      const double next = world.smooth_until(flight, to, kInfinity);
      if (!(next > to)) break;  // the segment ends there
      to = next;
    }
    // a step that fails at the end of the run, but for rounding, holds nothing up
    if (!(to > t) && all_.run.is_at_end(t)) return all_.run.duration();
    return std::min(all_.run.duration(), to);
  }
  if (flight.is_resting || !world.collides(body)) return all_.run.duration();
  const double advance = all_.lengths.advance;
  const double speed = world.velocity(body, flight, t).norm() +
                       std::sqrt(0.5 * world.gravity_world().norm() * advance);
  const double far =
      std::min(all_.run.duration(), t + std::max(advance / speed, 1e-9 * all_.run.step()));
  if (world.is_ball(body)) return far;
  const double near = std::min(all_.run.duration(), all_.run.impacts().window_end(t));
  return far > near && meets_nobody(body, flight, t, far) ? far : near;
}

// For any rotation: bounding balls are compared, nothing is searched.
bool Worker::meets_nobody(int body, const Flight& flight, double from, double to) const {
  const Box box = swept_box(body, std::min(from, global_virtual_time()), to);
  if (!is_alone() && !may_enter(body, box)) return false;
  for (const int plane : all_.planes)
    if (world().may_collide(body, plane) &&
        all_.run.impacts().may_meet(body, flight, plane, all_.immovable(plane), from, to))
      return false;
  bool is_nobody = true;
  for_each_in(box, [&](int other) {
    is_nobody = is_nobody && (other == body || !world().may_collide(body, other));
  });
  return is_nobody;
}

// The box that the body sweeps over [from, to], along all its flights.
Box Worker::swept_box(int body, double from, double to) const {
  const FlightHistory& flights = history(body);
  Box box;
  for (std::size_t k = flights.at(from); k < flights.size(); ++k)
    box.take_in(engines::swept_box(all_.world(), body, flights[k], std::max(from, flights[k].begin),
                                   k + 1 < flights.size() ? flights[k + 1].begin : to));
  return box;
}

double Worker::global_virtual_time() const {
  if (all_.regions > 1) return all_.global_virtual_time;
  const engines::EventQueue<Due>& queue = all_.domains[kBoundary].queue;
  return queue.empty() ? now : std::min(queue.front().key.time, now);
}

// All members of a process advance together; `body` is the first of them. None leaves the optimism
// window or the territory.
void Worker::advance(int body) {
  const Flight flight = history(body).back();
  const double from = process(body).horizon, gvt = global_virtual_time();
  double to = horizon_after(body, flight, from);
  // A rollback of a ball's flight costs the same for any horizon, so with one thread it needs no
  // window.
  const bool is_bounded = flight.segment >= 0 || all_.threads > 1;
  if (is_bounded && to > gvt + all_.optimism_window)
    to = std::max(from, gvt + all_.optimism_window);
  const auto own_end = all_.run.own_end(body, flight, to);
  if (own_end) to = own_end->time;
  const double swept_from = std::min(from, gvt);
  const auto members =
      flight.segment < 0
          ? std::span<const int>(&body, 1)
          : std::span<const int>(world().all_processes().segments().members(flight.segment));
  boxes_.clear();
  for (const int member : members) {
    boxes_.push_back(swept_box(member, swept_from, to));
    if (!is_alone() && !may_enter(member, boxes_.back()))
      return schedule_recheck(body, beyond(all_.site_of(body)));
  }
  found_.clear();
  if (own_end && own_end->time >= from) found_.push_back({*own_end, flight.version, 0});
  for (std::size_t k = 0; k < members.size(); ++k)
    advance_member(members[k], history(members[k]).back(), from, to, boxes_[k]);
  // The process advances at most to its first known impact; later ones are searched again if that
  // one is cancelled. Where another worker owns that impact, the advance is deferred too.
  for (const Due& due : found_) to = std::min(to, due.key.time);
  set_horizon(body, to);
  Site site = all_.site_of(body);
  for (const Due& due : found_) {
    if (due.key.time > to) continue;
    const Site its = all_.regions > 1 ? all_.site_of(due.key) : Site{};
    site = common(site, its);
    push(due, its);
  }
  schedule(body, site);
}

// After a rollback nothing may be lost: an advance that is impossible here is deferred to the
// worker that runs alone, which reports why it is impossible.
void Worker::advance_or_defer(int body) {
  if (is_alone()) return advance(body);
  try {
    advance(body);
  } catch (const engines::OutOfTime&) {
    throw;
  } catch (...) {
    schedule_recheck(body, Site{});
  }
}

void Worker::push(const Due& due, const Site& site) {
  if (is_mine(site))
    all_.domains[all_.domain_of(site)].queue.push(due);
  else
    deferred.due.emplace_back(due, site);
}

void Worker::advance_member(int body, const Flight& flight, double from, double to,
                            const Box& box) {
  ++counters.steps;
  ++counters.integrations;
  const std::uint64_t before =
      all_.work_loads.empty() ? 0 : cost.pair_checks + kGapChecks * cost.narrow.gap_evaluations;
  enter_box(body, box);
  find_obstacles(body, flight, from, to);
  for_each_partner(body, box, [&](int other) { check(body, flight, from, to, other); });
  if (all_.work_loads.empty()) return;
  const double checks =
      static_cast<double>(cost.pair_checks + kGapChecks * cost.narrow.gap_evaluations - before) +
      (flight.segment < 0 ? kStepChecks : kSegmentChecks);
  all_.work_loads[static_cast<std::size_t>(body)] += checks;
  work_load += checks;
}

// ---- Ownership -------------------------------------------------------------------------------

// While other threads run: only within the territory, and where the visible part of the boundary
// does not change. Segments change: a query computes their steps. A body on its own may cross the
// other pass's cut meanwhile, members of a process must not: they keep one site.
bool Worker::may_enter(int body, const Box& box) const {
  if (!world().processes())
    return holds(all_.territories[static_cast<std::size_t>(pass_)][territory_], box);
  if (!holds(all_.domains[all_.domain_of(body)].region, box)) return false;
  bool stands_still = true;
  for (const Domain* domain : visible_)
    if (!is_mine(domain->site) && domain->hull.overlaps(box))
      domain->pairs.for_each_in(box, [&](int other) {
        stands_still = stands_still && (!world().can_move(other) || has_only_flown(other));
      });
  return stands_still;
}

bool Worker::has_only_flown(int body) const {
  const FlightHistory& flights = history(body);
  for (std::size_t k = 0; k < flights.size(); ++k)
    if (flights[k].segment >= 0) return false;
  return true;
}

// A body whose box leaves a territory belongs to the boundary of that pass from now on.
void Worker::enter_box(int body, const Box& box) {
  if (all_.domains.size() == 1) return all_.domains.front().pairs.set_box(body, box);
  Site site = all_.site_of(body);
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    std::uint8_t& territory = site.territory[pass];
    if (territory != kBoundary && !holds(all_.territories[pass][territory], box))
      territory = kBoundary;
  }
  all_.enter(body, site, box);
}

// Members of a process that begins have one site from now on, so that one thread at a time computes
// its segments in the next pass, too.
void Worker::keep_together(const std::vector<engines::BegunFlight>& begun) {
  Site site = all_.site_of(begun.front().body);
  for (const engines::BegunFlight& flight : begun) site = common(site, all_.site_of(flight.body));
  for (const engines::BegunFlight& flight : begun)
    if (all_.site_of(flight.body) != site)
      all_.enter(flight.body, site, all_.domains.front().pairs.box(flight.body));
}

// After a rollback, what a body swept beyond that time concerns no other body.
void Worker::shrink_box(int body) {
  const double to = process(body).horizon;
  Box box = swept_box(body, std::min(to, global_virtual_time()), to);
  // not out of the territory, whatever rounding does: the previous box contains all that it sweeps
  if (!is_alone() || is_between_passes) {
    const Box& had = all_.domains.front().pairs.box(body);
    box = {box.low.cwiseMax(had.low), box.high.cwiseMin(had.high)};
  }
  enter_box(body, box);
}

// The grids have cells of one size: the body's own are looked up in each of them.
template <class Found>
void Worker::for_each_partner(int body, const Box& box, const Found& found) const {
  for (const Domain* domain : visible_)
    if (domain->hull.overlaps(box)) domain->pairs.for_each_partner(body, found);
}

template <class Found>
void Worker::for_each_in(const Box& box, const Found& found) const {
  for (const Domain* domain : visible_)
    if (domain->hull.overlaps(box)) domain->pairs.for_each_in(box, found);
}

// A body's local virtual time rises or falls.
void Worker::move(int body, double t) {
  double& horizon = process(body).horizon;
  if (all_.is_recorded && t != horizon && moves.size() >= engines::kMostMoves) {
    has_more_moves = true;
  } else if (all_.is_recorded && t != horizon) {
    const auto until_end = [&](double time) { return std::min(time, all_.run.duration()); };
    const auto row = std::lower_bound(world().movers().begin(), world().movers().end(), body) -
                     world().movers().begin();
    moves.push_back({static_cast<int>(row), until_end(horizon), until_end(t),
                     until_end(global_virtual_time())});
  }
  horizon = t;
}

void Worker::set_horizon(int body, double t) {
  const Flight& flight = history(body).back();
  move(body, t);
  if (flight.segment >= 0)
    for (const int member : world().members(body, flight)) move(member, t);
}

void Worker::find_obstacles(int body, const Flight& flight, double from, double to) {
  LogicalProcess& mine = process(body);
  if (all_.planes.empty()) return;
  if (!world().is_ball(body) || flight.segment >= 0) {
    for (const int plane : all_.planes) check(body, flight, from, to, plane);
    return;
  }
  // For a ball the first impact of the whole flight is found at once.
  if (mine.obstacle_version != flight.version) {
    mine.obstacle_version = flight.version;
    mine.obstacle_time = kInfinity;
    for (const int plane : all_.planes) {
      if (!world().may_collide(body, plane)) continue;
      if (!all_.run.impacts().has_closed_form(body, flight, plane, all_.immovable(plane))) {
        mine.obstacle_version = kAfterAll;  // a moving plane: query again
        check(body, flight, from, to, plane);
        continue;
      }
      const double time = all_.run.impacts().first_impact(body, flight, plane,
                                                          all_.immovable(plane), from, to, cost);
      if (time < mine.obstacle_time) {
        mine.obstacle_time = time;
        mine.obstacle = plane;
      }
    }
  }
  if (mine.obstacle_time >= from && mine.obstacle_time <= to)
    offer(body, flight, mine.obstacle, all_.immovable(mine.obstacle), mine.obstacle_time, nullptr);
}

// Establishes the invariant for the later body: of every two bodies all impacts up to the lesser of
// their horizons are known.
void Worker::check(int body, const Flight& flight, double from, double to, int other) {
  if (!world().may_collide(body, other)) return;
  if (!world().can_move(other)) {
    const double time =
        all_.run.impacts().first_impact(body, flight, other, all_.immovable(other), from, to, cost);
    if (time >= from && time <= to)
      offer(body, flight, other, all_.immovable(other), time, nullptr);
    return;
  }
  // two members of one process: checked once
  if (flight.segment >= 0 && history(other).back().segment == flight.segment) {
    if (other < body) return;
    const Flight& its = history(other).back();
    const double time = all_.run.impacts().first_impact(body, flight, other, its, from, to, cost);
    if (time >= from && time <= to) offer(body, flight, other, its, time, nullptr);
    return;
  }
  const double until = std::min(to, process(other).horizon);
  // The other body finds later impacts. Impacts at this very instant are found now: the other
  // advances only after all events of its instant, and this impact may have to precede some of
  // them.
  if (until < from) return;
  const FlightHistory& flights = history(other);
  std::size_t first = flights.at(from);
  // all flights at this instant: an earlier impact may have to precede a later one
  while (first > 0 && flights[first].begin == from) --first;
  for (std::size_t k = first; k < flights.size() && flights[k].begin <= until; ++k) {
    const Flight& its = flights[k];
    // A flight that ended at this instant is not continued beyond it: it would penetrate the body
    // that stopped it, where a search is costly.
    const double last = k + 1 < flights.size() && flights[k + 1].begin == from ? from : until;
    const double time = all_.run.impacts().first_impact(body, flight, other, its,
                                                        std::max(from, its.begin), last, cost);
    if (time >= from && time <= last)
      offer(body, flight, other, its, time, k + 1 < flights.size() ? &flights[k + 1] : nullptr);
  }
}

void Worker::offer(int body, const Flight& flight, int other, const Flight& its, double time,
                   const Flight* its_next) {
  const EventStamp key = engines::key_of_impact(body, flight, other, its, time);
  // the other was hit earlier
  if (its_next != nullptr && !(key < all_.begin_of(other, *its_next))) return;
  const bool is_a = key.body_a == body;
  found_.push_back({key, is_a ? flight.version : its.version, is_a ? its.version : flight.version});
}

void Worker::schedule(int body, const Site& site) {
  LogicalProcess& going = process(body);
  push({{going.horizon, kAfterAll, StampKind::kAdvance, body, -1}, ++going.version, 0}, site);
}

// After a rollback the impacts of that time are forgotten, those of the very instant, too: one of
// them may precede all that is known of the body.
void Worker::schedule_recheck(int body, const Site& site) {
  LogicalProcess& going = process(body);
  push({{going.horizon, 0, StampKind::kRecheck, body, -1}, ++going.version, 0}, site);
}

}  // namespace tumble::a4
