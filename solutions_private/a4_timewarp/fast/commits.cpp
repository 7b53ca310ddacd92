// Commit of events and frames. Part of Coordinator.
#include <algorithm>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "solutions_private/a4_timewarp/fast/coordinator.h"

namespace tumble::a4 {

bool Coordinator::is_current(int body, std::uint32_t version) const {
  return body < 0 || !all_.world().can_move(body) ||
         all_.histories[body].find(version) < all_.histories[body].size();
}

bool Coordinator::is_rolled_back(const Executed& event) const {
  return !is_current(event.key.body_a, event.version_a) ||
         !is_current(event.key.body_b, event.version_b);
}

// Counted by events, and not where a message is delivered: members of an island cancel each other's
// flights, and of two messages that cross neither finds anything left.
std::uint64_t Coordinator::anti_messages_of(const Executed& rolled_back) {
  return rolled_back.processes > 1 ? rolled_back.processes - 1 : 0;
}

// A commit is final: it lies before all pending events, and global virtual time never falls.
void Coordinator::require_certain(const EventStamp& key) const {
  if (key.time < all_.committed)
    throw PreconditionError(
        fmt::format("timewarp: global virtual time fell from {:.17g} s to {:.17g} s",
                    all_.committed, key.time));
  for (const Domain& domain : all_.domains)
    if (!domain.queue.empty() && domain.queue.front().key.time <= all_.run.duration() &&
        domain.queue.front().key < key)
      throw PreconditionError(
          fmt::format("timewarp: events before {:.17g} s are to be committed while an event at "
                      "{:.17g} s is pending",
                      key.time, domain.queue.front().key.time));
}

// Commits everything before `key` in order, with the frames between.
void Coordinator::commit_before(const EventStamp& key) {
  require_certain(key);
  hand_over_moves();
  // Collects the executed events of all workers, in their total order.
  std::vector<Executed>& executed = alone().executed;
  for (std::size_t k = 1; k < workers_.size(); ++k) {
    executed.insert(executed.end(), std::make_move_iterator(workers_[k]->executed.begin()),
                    std::make_move_iterator(workers_[k]->executed.end()));
    workers_[k]->executed.clear();
  }
  const auto in_order = [](const Executed& x, const Executed& y) { return x.key < y.key; };
  if (!std::is_sorted(executed.begin(), executed.end(), in_order))
    std::sort(executed.begin(), executed.end(), in_order);
  const auto flights_at = [&](double time) {
    return [this, time](int body) -> const Flight& {
      return all_.world().can_move(body) ? all_.histories[body][all_.histories[body].at(time)]
                                         : all_.immovable(body);
    };
  };
  const auto flights_before = [&](double time) {
    return [this, time](int body) -> const Flight& {
      if (!all_.world().can_move(body)) return all_.immovable(body);
      const FlightHistory& flights = all_.histories[body];
      std::size_t k = flights.at(time);
      while (k > 0 && !(flights[k].begin < time)) --k;
      return flights[k];
    };
  };
  const auto draw_before = [&](double until) {
    while (all_.run.next_frame() < until) all_.run.commit_frame(flights_at(all_.run.next_frame()));
  };
  // Commits events that are not rolled back, and the frames between them.
  std::size_t done = 0;
  for (; done < executed.size() && executed[done].key < key; ++done) {
    const Executed& event = executed[done];
    if (is_rolled_back(event)) {
      alone().counters.anti_messages += anti_messages_of(event);
      continue;
    }
    draw_before(event.key.time);
    all_.run.watch_order(event.key, flights_before(event.key.time));
    all_.run.count(event.noted.get());
    if (event.is_silent)
      all_.run.pass(event.key);
    else
      all_.run.commit(event.key, event.first, event.more);
  }
  // Commits the remaining frames, and releases what lies before the committed time.
  executed.erase(executed.begin(), executed.begin() + static_cast<std::ptrdiff_t>(done));
  draw_before(key.time);
  if (key.kind == StampKind::kFault) all_.run.commit_frame_at(key, flights_at(key.time));
  note_kept();
  all_.committed = std::min(key.time, all_.run.duration());
  if (all_.world().processes()) all_.world().processes()->segments().forget_before(all_.committed);
}

// At the end of the run: the flights that are still held, each as far as it was flown.
void Coordinator::stand(double until) {
  for (const int body : all_.world().movers()) {
    const FlightHistory& flights = all_.histories[body];
    for (std::size_t k = 0; k < flights.size(); ++k)
      all_.world().stand(flights[k],
                         k + 1 < flights.size() ? std::min(until, flights[k + 1].begin) : until);
  }
}

void Coordinator::note_kept() {
  std::int64_t kept = 0;
  for (const auto& worker : workers_) kept += worker->kept;
  if (workers_.size() == 1) kept = alone().most_kept;
  most_kept_ = std::max(
      most_kept_, kept + static_cast<std::int64_t>(all_.world().all_processes().segments().kept()));
}

}  // namespace tumble::a4
