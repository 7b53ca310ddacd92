// Execution of events, and rollback. Part of Worker.
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

// states: a search back over an epoch visits all of them each time, and they are kept to its end
constexpr std::size_t kMostOfABody = 256;

}  // namespace

Worker::Worker(Shared& all, int pass, std::uint8_t territory)
    : all_(all),
      pass_(pass),
      territory_(territory),
      random_(all.faults.seed + territory +
              (pass > 0 ? static_cast<std::uint64_t>(all.regions) : 0)) {
  for (Domain& domain : all.domains) {
    const bool is_of_boundary =
        !is_alone() && domain.site.territory[static_cast<std::size_t>(pass)] == kBoundary;
    if (is_mine(domain.site)) mine_.push_back(&domain);
    if (is_mine(domain.site) || is_of_boundary) visible_.push_back(&domain);
  }
}

bool Worker::is_mine(const EventStamp& key) const {
  if (is_alone()) return true;
  if (key.kind == StampKind::kCallback) return false;
  for (const int body : {key.body_a, key.body_b})
    if (all_.can_move(body) && !is_mine(body)) return false;
  return true;
}

// Whether all that share a segment with a body, now or as far back as a rollback may go, are this
// worker's. In the first pass they are; a process of the first pass may have taken a body to the
// boundary of the second, and left there the bodies of its earlier processes.
bool Worker::is_whole(int body) const {
  if (pass_ <= 0 || !world().processes()) return true;
  const FlightHistory& flights = history(body);
  for (std::size_t k = 0; k < flights.size(); ++k) {
    if (flights[k].segment < 0) continue;
    for (const int member : world().all_processes().segments().members(flights[k].segment))
      if (!is_mine(member)) return false;
  }
  return true;
}

bool Worker::is_whole(const EventStamp& key) const {
  for (const int body : {key.body_a, key.body_b})
    if (all_.can_move(body) && !is_whole(body)) return false;
  return true;
}

// The one with the first event of all; null: all queues are empty.
Domain* Worker::first_domain() const {
  Domain* first = nullptr;
  for (Domain* domain : mine_)
    if (!domain->queue.empty() && (!first || domain->queue.front().key < first->queue.front().key))
      first = domain;
  return first;
}

// ---- Impact ----------------------------------------------------------------------------------

// Whether the flight that an event names exists and the event is still to come on it.
bool Worker::look_up(const Due& due, int side, std::size_t& place) {
  const int body = side == 0 ? due.key.body_a : due.key.body_b;
  if (body < 0 || !world().can_move(body)) return true;
  // Rolled back since the event was found: an earlier event may now come first. The search finds it
  // again.
  if (process(body).horizon < due.key.time) return false;
  const FlightHistory& flights = history(body);
  place = flights.find(side == 0 ? due.version_a : due.version_b);
  if (place == flights.size()) return false;  // rolled back
  if (place + 1 == flights.size()) return true;
  // otherwise hit earlier, or a duplicate
  return due.key < all_.begin_of(body, flights[place + 1]);
}

bool Worker::is_to_come(const Due& due) {
  if (due.key.kind == StampKind::kCallback) return !all_.called[due.key.microstep];
  if (is_advance(due))
    return process(due.key.body_a).version == due.version_a &&
           all_.first_member(due.key.body_a) == due.key.body_a;
  std::size_t place = 0;
  return look_up(due, 0, place) && look_up(due, 1, place);
}

void Worker::count_by_region(const Due& due) {
  if (!is_alone()) ++counters.impacts_at_home;
  if (!world().can_move(due.key.body_a) || !world().can_move(due.key.body_b)) return;
  const std::uint8_t a = all_.last_region[static_cast<std::size_t>(due.key.body_a)],
                     b = all_.last_region[static_cast<std::size_t>(due.key.body_b)];
  if (a != kBoundary && b != kBoundary && a != b) ++counters.impacts_across;
}

void Worker::collide(const Due& due) {
  const int bodies[] = {due.key.body_a, due.key.body_b};
  const std::uint32_t versions[] = {due.version_a, due.version_b};
  // The event is stale unless both flights exist and it is their next one.
  std::size_t places[] = {0, 0};
  for (int side = 0; side < 2; ++side)
    if (!look_up(due, side, places[side])) return;
  if (due.key.kind == StampKind::kFault)
    all_.run.end_of_segment(due.key, history(bodies[0])[places[0]]);
  // Later flights of both bodies are rolled back.
  for (int side = 0; side < 2; ++side) {
    const int body = bodies[side];
    if (body < 0 || !world().can_move(body)) continue;
    if (places[side] + 1 < history(body).size()) roll_back(body, places[side] + 1);
    if (process(body).horizon > due.key.time) ++counters.undone_integrations;
  }
  // The response, and the flights that begin with it.
  const auto flight_of = [&](int side) -> const Flight& {
    return world().can_move(bodies[side])
               ? history(bodies[side])[history(bodies[side]).find(versions[side])]
               : all_.immovable(bodies[side]);
  };
  if (due.key.kind == StampKind::kProcess)
    return begin_flights(due, all_.run.end_of_segment(due.key, flight_of(0)));
  if (all_.threads > 1) count_by_region(due);
  engines::Discontinuity discontinuity =
      all_.run.resolve_impact(due.key, flight_of(0), flight_of(1), counters);
  if (!discontinuity.begun.empty()) return begin_flights(due, std::move(discontinuity));
  const std::uint32_t version_a =
      world().can_move(bodies[0]) ? process(bodies[0]).next_version++ : 0;
  const std::uint32_t version_b =
      world().can_move(bodies[1]) ? process(bodies[1]).next_version++ : 0;
  discontinuity.a.partner_version = version_b;
  discontinuity.b.partner_version = version_a;
  if (world().can_move(bodies[0])) begin_flight(bodies[0], discontinuity.a, version_a);
  if (world().can_move(bodies[1])) begin_flight(bodies[1], discontinuity.b, version_b);
  const auto processes = static_cast<std::size_t>(std::count_if(
      std::begin(bodies), std::end(bodies), [&](int body) { return world().can_move(body); }));
  executed.push_back({due.key, version_a, version_b, discontinuity.first,
                      std::move(discontinuity.more), false, processes,
                      std::move(discontinuity.noted)});
  for (const int body : bodies)
    if (world().can_move(body)) advance_or_defer(body);
}

// ---- Callback --------------------------------------------------------------------------------

void Worker::expect_callback(const EventStamp& key) {
  all_.called[key.microstep] = false;
  push({key, 0, 0}, Site{});
}

// Everything that its bodies did after its time is rolled back.
void Worker::call(const Due& due) {
  if (all_.called[due.key.microstep]) return;
  bool is_early = false;
  for (const int body : all_.run.receivers(due.key))
    // executed out of order: its bodies first have to advance to its time
    if (process(body).horizon < due.key.time) {
      advance(all_.first_member(body));
      is_early = true;
    }
  if (is_early) return push(due, Site{});
  for (const int body : all_.run.receivers(due.key)) {
    const FlightHistory& flights = history(body);
    std::size_t place = flights.size();
    while (place > 1 && due.key < all_.begin_of(body, flights[place - 1])) --place;
    if (place < flights.size()) roll_back(body, place);
  }
  all_.called[due.key.microstep] = true;
  begin_flights(due, all_.run.call(due.key, [this](int body) -> const Flight& {
    return history(body).back();
  }));
}

// All flights that an event on processes begins are recorded as one change, so that a rollback
// drops all of them.
void Worker::begin_flights(const Due& due, engines::Discontinuity discontinuity) {
  if (!is_alone()) keep_together(discontinuity.begun);
  const int change = all_.changes.add(due.key);
  std::uint32_t versions[] = {0, 0};
  for (engines::BegunFlight& begun : discontinuity.begun) {
    const std::uint32_t version = process(begun.body).next_version++;
    if (begun.body == due.key.body_a) versions[0] = version;
    if (begun.body == due.key.body_b) versions[1] = version;
    begun.flight.change = change;
    all_.changes.note(change, begun.body, version);
    begin_flight(begun.body, begun.flight, version);
  }
  executed.push_back({due.key, versions[0], versions[1], discontinuity.first,
                      std::move(discontinuity.more), discontinuity.is_silent,
                      discontinuity.begun.size(), std::move(discontinuity.noted)});
  for (const engines::BegunFlight& begun : discontinuity.begun)
    if (all_.first_member(begun.body) == begun.body) advance_or_defer(begun.body);
}

void Worker::begin_flight(int body, Flight flight, std::uint32_t version) {
  flight.version = version;
  purge(body);
  all_.histories.push(body, flight);
  most_kept = std::max(most_kept, ++kept);
  longest = std::max(longest, history(body).size());
  counters.most_states = std::max<std::uint64_t>(counters.most_states, longest);
  move(body, flight.begin);
}

void Worker::purge(int body) {
  all_.histories.purge(body, all_.committed, [&](const Flight& purged, const Flight& next) {
    world().stand(purged, next.begin);
    forget(purged);
    --kept;
  });
}

// ---- Limit of states -------------------------------------------------------------------------

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
    const std::size_t steps =
        last.segment < 0 ? 0 : world().all_processes().segments().kept(last.segment);
    has_room = has_room &&
               std::max(history(body).size(), steps) < static_cast<std::size_t>(all_.most_states);
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

void Worker::roll_back_from(int body, std::uint32_t version) {
  const std::size_t place = history(body).find(version);
  if (place == history(body).size()) return;  // already rolled back
  roll_back(body, place);
}

// Sends an anti-message: executed at once for a body of this worker, deferred for another's.
void Worker::cancel(int body, std::uint32_t version) {
  if (!is_mine(body)) return deferred.anti_messages.push_back({body, version});
  const std::size_t effect = history(body).find(version);
  if (effect == history(body).size()) return;  // already rolled back
  to_drop_.emplace_back(body, effect);
}

// Drops the flights of a body from index `keep` on, and by anti-messages the flights of others that
// began with them, and so on.
void Worker::roll_back(int body, std::size_t keep) {
  to_drop_.assign(1, {body, keep});
  while (!to_drop_.empty()) {
    const auto [now_at, place] = to_drop_.back();
    // The work list: bodies of this worker whose flights must be dropped.
    to_drop_.pop_back();
    const FlightHistory& flights = history(now_at);
    if (flights.size() <= place) continue;
    ++counters.rollbacks;
    while (flights.size() > place) {
      const Flight dropped = flights.back();
      require(dropped.begin >= all_.committed, "timewarp: a committed flight is to be rolled back");
      all_.histories.pop(now_at);
      --kept;
      ++counters.undone_integrations;
      move(now_at, std::min(process(now_at).horizon, dropped.begin));
      // Anti-messages to all other flights of the same event.
      if (dropped.change >= 0) {
        if (all_.changes.key(dropped.change).kind == StampKind::kCallback)
          cancel_callback(all_.changes.key(dropped.change));
        for (const auto& [other, version] : all_.changes.began(dropped.change))
          cancel(other, version);
        forget(dropped);
      } else if (world().can_move(dropped.partner)) {
        cancel(dropped.partner, dropped.partner_version);
      }
    }
    shrink_box(now_at);
    if (all_.first_member(now_at) == now_at) schedule_recheck(now_at);
  }
}

void Worker::cancel_callback(const EventStamp& key) {
  if (!is_alone())
    deferred.cancelled_callbacks.push_back(key);
  else if (all_.called[key.microstep])
    expect_callback(key);
}

// ---- Event loop ------------------------------------------------------------------------------

void Worker::work_at(const Due& due) {
  now = due.key.time;
  if (due.key.kind == StampKind::kCallback)
    call(due);
  else if (!is_advance(due))
    collide(due);
  else if (is_to_come(due)) {
    // nothing is left to find
    if (process(due.key.body_a).horizon >= all_.run.duration())
      set_horizon(due.key.body_a, kInfinity);
    else
      advance(due.key.body_a);
  }
  now = kInfinity;
}

// An error here may be a consequence of something that will be rolled back: the event is deferred,
// and fails again if it stands. Running out of time is no such error.
double Worker::work_before(double end) {
  const double began = thread_seconds();
  const double last = all_.run.duration();
  // Events in order, to `end` or to the end of the run.
  Domain* next = first_domain();
  const auto is_to_do = [&] {
    return next && next->queue.front().key.time < end && next->queue.front().key.time <= last;
  };
  longest = 0;
  for (; is_to_do(); next = first_domain()) {
    if (all_.threads == 1 && longest > kMostOfABody) break;
    if (all_.faults.delay_s > 0) delay();
    if (all_.faults.rollback_every > 0) disturb();
    const Due due = all_.faults.disorder_s > 0
                        ? next_legal(next->queue, std::min(last, std::nextafter(end, 0.0)))
                        : next->queue.pop();
    if (!next->queue.empty()) fetch(next->queue.front());
    if (!is_mine(due.key)) {
      deferred.due.emplace_back(due, beyond(next->site));
    } else if (!is_whole(due.key)) {
      defer(due);
    } else if (all_.most_states > 0 && !has_room(due)) {
      ++counters.held_back;
      defer(due);
    } else if (due.key.kind == StampKind::kFault) {
      defer(due);  // what other workers do may prevent it
    } else {
      ++worked_at;
      try {
        work_at(due);
      } catch (const engines::OutOfTime&) {
        deferred.out_of_time = std::current_exception();
        break;
      } catch (...) {
        defer(due);
      }
    }
  }
  now = kInfinity;
  next = first_domain();
  cpu_seconds += thread_seconds() - began;
  return is_to_do() ? next->queue.front().key.time : end;
}

// A body that waits for an impact does not advance before it: it would find the same impact again
// and again.
void Worker::defer(const Due& due) {
  deferred.due.emplace_back(due, Site{});
  if (is_advance(due)) return;
  for (const int body : {due.key.body_a, due.key.body_b})
    if (all_.can_move(body) && is_whole(body)) schedule(all_.first_member(body), Site{});
}

// Prefetches the data of the next event while this one is executed: in scenes of many bodies half
// the time is memory latency.
void Worker::fetch(const Due& due) const {
  for (const int body : {due.key.body_a, due.key.body_b}) {
    if (body < 0) continue;
    __builtin_prefetch(&all_.processes[static_cast<std::size_t>(body)]);
    all_.histories.fetch(body);
    all_.domains.front().pairs.fetch(body);
  }
}

// ---- Fault injection -------------------------------------------------------------------------

// A random event that is not too far ahead of global virtual time.
Due Worker::next_legal(engines::EventQueue<Due>& queue, double last) {
  const double latest = std::min(
      last, queue.front().key.time + std::min(all_.faults.disorder_s, all_.optimism_window));
  std::vector<Due> taken;
  const std::uint64_t most = 1 + random_.below(256);
  while (taken.size() < most && !queue.empty() && queue.front().key.time <= latest)
    taken.push_back(queue.pop());
  const std::size_t chosen = random_.below(taken.size());
  for (std::size_t k = 0; k < taken.size(); ++k)
    if (k != chosen) queue.push(taken[k]);
  return taken[chosen];
}

void Worker::disturb() {
  if (++since_disturbed_ % static_cast<std::uint64_t>(all_.faults.rollback_every) != 0) return;
  const std::vector<int>& movers = world().movers();
  const int body = movers[random_.below(movers.size())];
  const double back = random_.between(0.0, all_.faults.rollback_s);
  if (!is_mine(body) || !is_whole(body)) return;
  const double back_to =
      std::max(global_virtual_time(), std::min(process(body).horizon, all_.run.duration()) - back);
  if (back_to < process(body).horizon) roll_back_to(body, back_to);
}

void Worker::roll_back_to(int body, double t) {
  roll_back(body, history(body).at(t) + 1);
  purge(body);
  if (t < process(body).horizon) {
    set_horizon(body, t);
    schedule_recheck(all_.first_member(body));
  }
  for (const int member : world().members(body, history(body).back())) shrink_box(member);
}

void Worker::delay() {
  constexpr std::uint64_t kOneIn = 16;  // events
  if (random_.below(kOneIn) == 0)
    std::this_thread::sleep_for(
        std::chrono::duration<double>(random_.between(0.0, all_.faults.delay_s)));
}

}  // namespace tumble::a4
