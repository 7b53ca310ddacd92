// How far a process goes, and whom it may meet on the way. Part of FastTimewarp.
#include "solutions_private/a4_timewarp/fast/scheduler.h"

#include <algorithm>
#include <cmath>

#include "framework/engines/timewarp/fast_timewarp.h"

namespace tumble::a4 {

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

}  // namespace tumble::a4
