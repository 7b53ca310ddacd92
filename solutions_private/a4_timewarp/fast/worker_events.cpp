// What happens, and what of it is taken back. Part of Worker.
#include "framework/core/numbers.h"
#include "solutions_private/a4_timewarp/fast/worker.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/engines/base/guarded_laws.h"

namespace tumble::a4 {
namespace {

constexpr std::size_t kMostOfABody = 256;   // states: looking back over a round costs as many each time, and they are kept to its end

}  // namespace

// ---- An impact ---------------------------------------------------------------------------------------------------------

// Whether the flight that an event speaks of is there and the event still to come on it.
bool Worker::look_up(const Due& due, int side, std::size_t& place) {
  const int body = side == 0 ? due.key.body_a : due.key.body_b;
  if (body < 0 || !world().can_move(body)) return true;
  // Rolled back since the event was found: on the way there something else may come first. It will be found again.
  if (process(body).horizon < due.key.time) return false;
  const FlightHistory& flights = history(body);
  place = flights.find(side == 0 ? due.serial_a : due.serial_b);
  if (place == flights.size()) return false;   // taken back
  if (place + 1 == flights.size()) return true;
  return due.key < all_.begin_of(body, flights[place + 1]);   // else hit before, or known twice
}

bool Worker::is_to_come(const Due& due) {
  if (due.key.kind == EventClass::kCallback) return !all_.called[due.key.generation];
  if (goes_on(due)) return process(due.key.body_a).ticket == due.serial_a && all_.first_member(due.key.body_a) == due.key.body_a;
  std::size_t place = 0;
  return look_up(due, 0, place) && look_up(due, 1, place);
}

void Worker::note_whose_territory(const Due& due) {
  if (!is_alone()) ++counters.impacts_at_home;
  if (!world().can_move(due.key.body_a) || !world().can_move(due.key.body_b)) return;
  const std::uint8_t a = all_.last_territory[static_cast<std::size_t>(due.key.body_a)], b = all_.last_territory[static_cast<std::size_t>(due.key.body_b)];
  if (a != kBorder && b != kBorder && a != b) ++counters.impacts_across;
}

void Worker::collide(const Due& due) {
  const int bodies[] = {due.key.body_a, due.key.body_b};
  const std::uint32_t serials[] = {due.serial_a, due.serial_b};
  std::size_t places[] = {0, 0};
  for (int side = 0; side < 2; ++side)
    if (!look_up(due, side, places[side])) return;
  for (int side = 0; side < 2; ++side) {
    const int body = bodies[side];
    if (body < 0 || !world().can_move(body)) continue;
    if (places[side] + 1 < history(body).size()) roll_back(body, places[side] + 1);
    if (process(body).horizon > due.key.time) ++counters.undone_integrations;
  }
  const auto flight_of = [&](int side) -> const Flight& { return world().can_move(bodies[side]) ? history(bodies[side])[history(bodies[side]).find(serials[side])] : all_.immovable(bodies[side]); };
  if (due.key.kind == EventClass::kProcess) return begin_flights(due, all_.run.end_of_passage(due.key, flight_of(0)));
  if (all_.threads > 1) note_whose_territory(due);
  engines::Meeting meeting = all_.run.meet(due.key, flight_of(0), flight_of(1), counters);
  if (!meeting.begun.empty()) return begin_flights(due, std::move(meeting));
  const std::uint32_t serial_a = world().can_move(bodies[0]) ? process(bodies[0]).next_serial++ : 0;
  const std::uint32_t serial_b = world().can_move(bodies[1]) ? process(bodies[1]).next_serial++ : 0;
  meeting.a.partner_serial = serial_b;
  meeting.b.partner_serial = serial_a;
  if (world().can_move(bodies[0])) begin_flight(bodies[0], meeting.a, serial_a);
  if (world().can_move(bodies[1])) begin_flight(bodies[1], meeting.b, serial_b);
  executed.push_back({due.key, serial_a, serial_b, meeting.first, std::move(meeting.more)});
  for (const int body : bodies)
    if (world().can_move(body)) advance_or_leave(body);
}

// ---- A callback --------------------------------------------------------------------------------------------------------

void Worker::expect_callback(const EventKey& key) {
  all_.called[key.generation] = false;
  push({key, 0, 0}, kBorder);
}

// Whatever its bodies have done beyond its time was done without it, and is taken back.
void Worker::call(const Due& due) {
  if (all_.called[due.key.generation]) return;
  bool is_early = false;
  for (const int body : all_.run.receivers(due.key))
    if (process(body).horizon < due.key.time) {   // taken out of its order: its bodies first have to come as far
      advance(all_.first_member(body));
      is_early = true;
    }
  if (is_early) return push(due, kBorder);
  for (const int body : all_.run.receivers(due.key)) {
    const FlightHistory& flights = history(body);
    std::size_t place = flights.size();
    while (place > 1 && due.key < all_.begin_of(body, flights[place - 1])) --place;
    if (place < flights.size()) roll_back(body, place);
  }
  all_.called[due.key.generation] = true;
  begin_flights(due, all_.run.call(due.key, [this](int body) -> const Flight& { return history(body).back(); }));
}

// What an event does to processes: all that it begins is noted as one change, so that all of it can be taken back.
void Worker::begin_flights(const Due& due, engines::Meeting meeting) {
  const int change = all_.changes.add(due.key);
  std::uint32_t serials[] = {0, 0};
  for (engines::BegunFlight& begun : meeting.begun) {
    const std::uint32_t serial = process(begun.body).next_serial++;
    if (begun.body == due.key.body_a) serials[0] = serial;
    if (begun.body == due.key.body_b) serials[1] = serial;
    begun.flight.change = change;
    all_.changes.note(change, begun.body, serial);
    begin_flight(begun.body, begun.flight, serial);
  }
  executed.push_back({due.key, serials[0], serials[1], meeting.first, std::move(meeting.more), meeting.is_silent});
  for (const engines::BegunFlight& begun : meeting.begun)
    if (all_.first_member(begun.body) == begun.body) advance_or_leave(begun.body);
}

void Worker::begin_flight(int body, Flight flight, std::uint32_t serial) {
  flight.serial = serial;
  purge(body);
  all_.histories.push(body, flight);
  most_kept = std::max(most_kept, ++kept);
  longest = std::max(longest, history(body).size());
  counters.most_states = std::max<std::uint64_t>(counters.most_states, longest);
  move(body, flight.begin);
}

void Worker::purge(int body) {
  all_.histories.purge(body, all_.committed, [&](const Flight& purged) {
    forget(purged);
    --kept;
  });
}

// ---- Not too many states ---------------------------------------------------------------------------------------------------

template <class Work>
void Worker::for_each_member(const Due& due, const Work& work) {
  for (const int body : {due.key.body_a, due.key.body_b}) {
    if (body < 0 || !world().can_move(body)) continue;
    for (const int member : world().members(body, history(body).back())) work(member);
  }
}

bool Worker::has_room(const Due& due) {
  bool has_room = true;
  for_each_member(due, [&](int body) {
    const Flight& last = history(body).back();
    const std::size_t steps = last.passage < 0 ? 0 : world().all_processes().passages().kept(last.passage);
    has_room = has_room && std::max(history(body).size(), steps) < static_cast<std::size_t>(all_.most_states);
  });
  return has_room;
}

void Worker::purge(const Due& due) {
  for_each_member(due, [this](int body) { purge(body); });
}

void Worker::forget(const Flight& flight) {
  world().release(flight);
  if (flight.change >= 0) all_.changes.release(flight.change);
}

void Worker::take_back(int body, std::uint32_t serial) {
  const std::size_t place = history(body).find(serial);
  if (place == history(body).size()) return;   // taken back already
  ++counters.anti_messages;
  roll_back(body, place);
}

// An anti-message: to a flight of one's own at once, to another's when its turn comes.
void Worker::unsend(int body, std::uint32_t serial) {
  if (!is_mine(body)) return left.anti_messages.push_back({body, serial});
  const std::size_t effect = history(body).find(serial);
  if (effect == history(body).size()) return;   // taken back already
  ++counters.anti_messages;
  to_drop_.emplace_back(body, effect);
}

// Drops the flights of a body from place `keep` on, and by anti-messages those of others that began with them, and so on.
void Worker::roll_back(int body, std::size_t keep) {
  to_drop_.assign(1, {body, keep});
  while (!to_drop_.empty()) {
    const auto [now_at, place] = to_drop_.back();
    to_drop_.pop_back();
    const FlightHistory& flights = history(now_at);
    if (flights.size() <= place) continue;
    ++counters.rollbacks;
    while (flights.size() > place) {
      const Flight dropped = flights.back();
      require(dropped.begin >= all_.committed, "timewarp: what is committed is to be taken back");
      all_.histories.pop(now_at);
      --kept;
      ++counters.undone_integrations;
      move(now_at, std::min(process(now_at).horizon, dropped.begin));
      if (dropped.change >= 0) {
        if (all_.changes.key(dropped.change).kind == EventClass::kCallback) recall(all_.changes.key(dropped.change));
        for (const auto& [other, serial] : all_.changes.began(dropped.change)) unsend(other, serial);
        forget(dropped);
      } else if (world().can_move(dropped.partner)) {
        unsend(dropped.partner, dropped.partner_serial);
      }
    }
    shrink_box(now_at);
    if (all_.first_member(now_at) == now_at) look_again(now_at);
  }
}

void Worker::recall(const EventKey& key) {
  if (!is_alone()) left.recalls.push_back(key);
  else if (all_.called[key.generation]) expect_callback(key);
}

// ---- Going round ---------------------------------------------------------------------------------------------------------

void Worker::work_at(const Due& due) {
  now = due.key.time;
  if (due.key.kind == EventClass::kCallback) call(due);
  else if (!goes_on(due)) collide(due);
  else if (is_to_come(due)) {
    if (process(due.key.body_a).horizon >= all_.run.duration()) set_horizon(due.key.body_a, kInfinity);   // nothing is left to find
    else advance(due.key.body_a);
  }
  now = kInfinity;
}

// What goes wrong here may be a consequence of what will be taken back: it is left, and goes wrong again if it stands. Time that is up is not.
double Worker::work_before(double end) {
  const double began = thread_seconds();
  const double last = all_.run.duration();
  engines::EventQueue<Due>& queue = all_.domains[home_].queue;
  const auto is_to_do = [&] { return !queue.empty() && queue.front().key.time < end && queue.front().key.time <= last; };
  longest = 0;
  while (is_to_do()) {
    if (all_.threads == 1 && longest > kMostOfABody) break;
    if (all_.trial.delay_s > 0) delay();
    if (all_.trial.rollback_every > 0) disturb();
    const Due due = all_.trial.disorder_s > 0 ? next_legal(std::min(last, std::nextafter(end, 0.0))) : queue.pop();
    if (!queue.empty()) fetch(queue.front());
    if (all_.home_of(due.key) != home_) {
      left.due.push_back(due);
    } else if (all_.most_states > 0 && !has_room(due)) {
      ++counters.held_back;
      leave(due);
    } else {
      ++worked_at;
      try {
        work_at(due);
      } catch (const engines::OutOfTime&) {
        left.out_of_time = std::current_exception();
        break;
      } catch (...) {
        leave(due);
      }
    }
  }
  now = kInfinity;
  cpu_seconds += thread_seconds() - began;
  return is_to_do() ? queue.front().key.time : end;
}

// Who waits for an impact does not go on before it: it would find the same impact again and again.
void Worker::leave(const Due& due) {
  left.due.push_back(due);
  if (goes_on(due)) return;
  for (const int body : {due.key.body_a, due.key.body_b})
    if (body >= 0 && world().can_move(body)) schedule(all_.first_member(body), kBorder);
}

// What the next event will look at is on its way from memory while this one is worked at: in scenes of many bodies that is half the time.
void Worker::fetch(const Due& due) const {
  for (const int body : {due.key.body_a, due.key.body_b}) {
    if (body < 0) continue;
    __builtin_prefetch(&all_.processes[static_cast<std::size_t>(body)]);
    all_.histories.fetch(body);
    all_.domains[home_].pairs.fetch(body);
  }
}

// ---- What tests do to it ---------------------------------------------------------------------------------------------------

// Any event that is not too far ahead of global virtual time may be taken: which, is drawn by lot.
Due Worker::next_legal(double last) {
  engines::EventQueue<Due>& queue = all_.domains[home_].queue;
  const double latest = std::min(last, queue.front().key.time + std::min(all_.trial.disorder_s, all_.window));
  std::vector<Due> taken;
  const std::uint64_t most = 1 + random_.below(256);
  while (taken.size() < most && !queue.empty() && queue.front().key.time <= latest) taken.push_back(queue.pop());
  const std::size_t chosen = random_.below(taken.size());
  for (std::size_t k = 0; k < taken.size(); ++k)
    if (k != chosen) queue.push(taken[k]);
  return taken[chosen];
}

void Worker::disturb() {
  if (++since_disturbed_ % static_cast<std::uint64_t>(all_.trial.rollback_every) != 0) return;
  const std::vector<int>& movers = world().movers();
  const int body = movers[random_.below(movers.size())];
  const double back = random_.between(0.0, all_.trial.rollback_s);
  if (!is_mine(body)) return;
  const double back_to = std::max(global_virtual_time(), std::min(process(body).horizon, all_.run.duration()) - back);
  if (back_to < process(body).horizon) go_back(body, back_to);
}

void Worker::go_back(int body, double t) {
  roll_back(body, history(body).at(t) + 1);
  purge(body);
  if (t < process(body).horizon) {
    set_horizon(body, t);
    look_again(all_.first_member(body));
  }
  for (const int member : world().members(body, history(body).back())) shrink_box(member);
}

void Worker::delay() {
  constexpr std::uint64_t kOneIn = 16;   // events
  if (random_.below(kOneIn) == 0) std::this_thread::sleep_for(std::chrono::duration<double>(random_.between(0.0, all_.trial.delay_s)));
}

}  // namespace tumble::a4
