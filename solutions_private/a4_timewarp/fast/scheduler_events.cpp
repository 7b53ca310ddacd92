// What happens, what of it is taken back, and what is committed. Part of FastTimewarp.
#include "solutions_private/a4_timewarp/fast/scheduler.h"

#include <algorithm>
#include <cmath>

namespace tumble::a4 {

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

}  // namespace tumble::a4
