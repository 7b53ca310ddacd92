/// One thread of the fast scheduler: it advances processes, executes their events, and rolls them
/// back. Its parts: worker_advance.cpp and worker_events.cpp. The coordinator (coordinator.h)
/// decides which worker runs when.
///
/// The worker of a territory changes only bodies that lie in it, and reads those of the boundary of
/// its pass. It defers everything else that an event needs: events, anti-messages, processes that
/// would leave the territory. A worker of the second pass takes what those of the first have
/// deferred, as far as its territory holds it. One worker has no territory: it runs alone, on all
/// bodies.
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
  /// The worker that runs alone.
  explicit Worker(Shared& all) : Worker(all, kAlone, kBoundary) {}
  /// @param pass       0 or 1
  /// @param territory  of that pass, from 1 on
  /// @pre all domains exist
  Worker(Shared& all, int pass, std::uint8_t territory);

  /// Executes the events before `end`, in order, in this worker's territory.
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
  /// For tests: a random choice of the next event, among those of a queue that may be executed.
  Due next_legal(engines::EventQueue<Due>& queue, double last);

  /// Work that belongs to another worker.
  struct Deferred {
    // events, and a site that has no more territories than the workers that may execute them
    std::vector<std::pair<Due, Site>> due;
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
  // of the one that runs alone: between two passes, where no body may leave its territories
  bool is_between_passes = false;
  std::uint64_t worked_at = 0;  // events, in work_before
  // time of the event in execution: it is not in the queue any more, but not finished [s]
  double now = kInfinity;

 private:
  static constexpr int kAlone = -1;

  bool is_alone() const { return pass_ == kAlone; }
  const FlightWorld& world() const { return all_.world(); }
  LogicalProcess& process(int body) { return all_.processes[static_cast<std::size_t>(body)]; }
  const FlightHistory& history(int body) const { return all_.histories[body]; }
  bool is_mine(const Site& site) const {
    return is_alone() || site.territory[static_cast<std::size_t>(pass_)] == territory_;
  }
  // reads nothing that another thread may write meanwhile
  bool is_mine(int body) const {
    return is_alone() ||
           all_.territory_of[static_cast<std::size_t>(pass_)][static_cast<std::size_t>(body)] ==
               territory_;
  }
  bool is_mine(const EventStamp& key) const;
  bool is_whole(int body) const;
  bool is_whole(const EventStamp& key) const;
  // the site of what this worker must leave to others
  Site beyond(Site site) const {
    if (!is_alone()) site.territory[static_cast<std::size_t>(pass_)] = kBoundary;
    return site;
  }
  Domain* first_domain() const;

  void advance(int body);
  void advance_or_defer(int body);
  void advance_member(int body, const Flight& flight, double from, double to, const Box& box);
  void push(const Due& due, const Site& site);
  bool may_enter(int body, const Box& box) const;
  void keep_together(const std::vector<engines::BegunFlight>& begun);
  bool has_only_flown(int body) const;
  void enter_box(int body, const Box& box);
  template <class Found>
  void for_each_partner(int body, const Box& box, const Found& found) const;
  template <class Found>
  void for_each_in(const Box& box, const Found& found) const;
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
  void schedule(int body, const Site& site);
  void schedule_recheck(int body, const Site& site);
  void schedule_recheck(int body) { schedule_recheck(body, all_.site_of(body)); }
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
  const int pass_;
  const std::uint8_t territory_;
  std::vector<Domain*> mine_;           // those of its territory
  std::vector<const Domain*> visible_;  // and those of the boundary of its pass
  Random random_;
  std::vector<std::pair<int, std::size_t>> to_drop_;  // of roll_back, a member to keep its memory
  template <class Work>
  void for_each_member(const Due& due, const Work& work);

  std::vector<Due> found_;  // of advance
  std::vector<Box> boxes_;  // of advance: by member
  std::uint64_t since_disturbed_ = 0;
};

}  // namespace tumble::a4
