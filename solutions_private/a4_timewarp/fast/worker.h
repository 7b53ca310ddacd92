/// One thread of the fast scheduler: it advances processes, executes their events, and rolls them
/// back. Its parts: worker_advance.cpp and worker_events.cpp. The coordinator (coordinator.h)
/// decides which worker runs when.
///
/// The worker of a region changes only bodies that the region owns, and reads those of the
/// boundary. It defers everything else that an event needs: events, anti-messages, processes that
/// would leave the region. The worker of the boundary runs alone, on all bodies.
#pragma once

#include <exception>
#include <utility>
#include <vector>

#include "framework/core/numbers.h"
#include "framework/core/random.h"
#include "solutions_private/a4_timewarp/fast/shared.h"

namespace tumble::a4 {

class alignas(64) Worker {
 public:
  Worker(Shared& all, std::size_t owner)
      : all_(all), owner_(owner), random_(all.faults.seed + owner) {}

  /// Executes the events before `end`, in order, in this worker's region.
  /// @return `end`; with one thread less where a body has had very many events: the time that was
  ///   reached, where the epoch may end
  double work_before(double end);
  /// Executes one event from a queue. @throws StoppedRun
  void work_at(const Due& due);
  /// Whether no body of the event would then exceed the limit of states.
  bool has_room(const Due& due);
  /// Discards its bodies' states before the committed time.
  void purge(const Due& due);
  /// The first advance of a process.
  void begin(int body) { advance(body); }
  void expect_callback(const EventStamp& key);
  /// Drops the flights of a body from this version on, and cancels their effects on others.
  void roll_back_from(int body, std::uint32_t version);
  /// Prefetches the data of an event.
  void fetch(const Due& due) const;
  /// Whether an event in a queue is current, and not stale.
  bool is_to_come(const Due& due);
  /// For tests: rolls a body back by up to the injected fault's time.
  void disturb();
  /// For tests: rolls a body back to t as if it had never advanced past it. @pre t is not before
  /// the committed time
  void roll_back_to(int body, double t);
  /// For tests: a random choice of the next event, among those that may be executed.
  Due next_legal(double last);

  /// Work that belongs to another worker.
  struct Deferred {
    std::vector<Due> due;
    // body, and version of its flight that must be dropped
    std::vector<std::pair<int, std::uint32_t>> anti_messages;
    // callbacks that must be executed again
    std::vector<EventStamp> cancelled_callbacks;
    // out of time: this worker has stopped, and all others must
    std::exception_ptr out_of_time;
  };
  Deferred deferred;
  std::vector<Executed> executed;
  std::vector<VirtualTimes::Move> moves;
  bool has_more_moves = false;  // than are recorded
  engines::RunCounters counters;
  engines::CheckCost cost;
  // largest number of states of a body since work_before began
  std::size_t longest = 0;
  std::int64_t kept = 0, most_kept = 0;  // flights; for one worker the change that it made
  double work_load = 0.0;                // of all its bodies, since the last partition
  double cpu_seconds = 0.0;              // CPU time of work_before
  std::uint64_t worked_at = 0;           // events, in work_before
  // time of the event in execution: it is not in the queue any more, but not finished [s]
  double now = kInfinity;

 private:
  bool is_alone() const { return owner_ == kBoundary; }
  const FlightWorld& world() const { return all_.world(); }
  LogicalProcess& process(int body) { return all_.processes[static_cast<std::size_t>(body)]; }
  const FlightHistory& history(int body) const { return all_.histories[body]; }
  bool is_mine(int body) const {
    return is_alone() || all_.owner[static_cast<std::size_t>(body)] == owner_;
  }

  void advance(int body);
  void advance_or_defer(int body);
  void advance_member(int body, const Flight& flight, double from, double to, const Box& box);
  void push(const Due& due, std::size_t owner);
  bool may_enter(const Box& box) const;
  bool has_only_flown(int body) const;
  void enter_box(int body, const Box& box);
  template <class Found>
  void for_each_partner(int body, const Box& box, const Found& found) const;
  template <class Found>
  void for_each_in(std::size_t owner, const Box& box, const Found& found) const;
  template <class Found>
  void for_each_elsewhere(std::size_t owner, const Box& box, const Found& found) const;
  bool meets_nobody(int body, const Flight& flight, double from, double to) const;
  void find_obstacles(int body, const Flight& flight, double from, double to);
  void check(int body, const Flight& flight, double from, double to, int other);
  void offer(int body, const Flight& flight, int other, const Flight& its, double time,
             const Flight* its_next);
  double horizon_after(int body, const Flight& flight, double t) const;
  Box swept_box(int body, double from, double to) const;
  void move(int body, double t);
  void set_horizon(int body, double t);
  void shrink_box(int body);
  void schedule(int body, std::size_t owner);
  void schedule(int body) { schedule(body, all_.owner[static_cast<std::size_t>(body)]); }
  void schedule_recheck(int body, std::size_t owner);
  void schedule_recheck(int body) {
    schedule_recheck(body, all_.owner[static_cast<std::size_t>(body)]);
  }
  double global_virtual_time() const;

  void collide(const Due& due);
  void count_by_region(const Due& due);
  bool look_up(const Due& due, int side, std::size_t& place);
  void call(const Due& due);
  void begin_flights(const Due& due, engines::Discontinuity discontinuity);
  void begin_flight(int body, Flight flight, std::uint32_t version);
  void purge(int body);
  void forget(const Flight& flight);
  void roll_back(int body, std::size_t keep);
  void cancel(int body, std::uint32_t version);
  void cancel_callback(const EventStamp& key);
  void delay();
  void defer(const Due& due);

  Shared& all_;
  const std::size_t owner_;
  Random random_;
  std::vector<std::pair<int, std::size_t>> to_drop_;  // of roll_back, a member to keep its memory
  template <class Work>
  void for_each_member(const Due& due, const Work& work);

  std::vector<Due> found_;  // of advance
  std::vector<Box> boxes_;  // of advance: by member
  std::uint64_t since_disturbed_ = 0;
};

}  // namespace tumble::a4
