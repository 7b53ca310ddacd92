/// The fast scheduler's own state: processes, what they have done, what is to come. Its parts: scheduler.cpp goes round, scheduler_advance.cpp
/// takes processes on, scheduler_events.cpp does what happens and takes it back, and commits.
#pragma once

#include <limits>
#include <vector>

#include "framework/core/random.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/timewarp/active_pairs.h"
#include "framework/engines/timewarp/event_queue.h"
#include "framework/engines/timewarp/flight_histories.h"
#include "framework/trajectory/virtual_times.h"
#include "solutions_private/a4_timewarp/fast/changes.h"
#include "solutions_private/a4_timewarp/fast/lengths.h"

namespace tumble::a4 {

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

}  // namespace tumble::a4
