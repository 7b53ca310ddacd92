/// The teaching timewarp. Its parts: taught_timewarp.cpp has the loop and checks, taught_events.cpp
/// executes events, taught_rollback.cpp rolls back and commits.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/engines/events/flight_run.h"
#include "framework/engines/base/frame_times.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/timewarp/taught_groups.h"
#include "framework/engines/timewarp/taught_logical_process.h"
#include "framework/engines/timewarp/taught_queue.h"
#include "framework/engines/timewarp/taught_search.h"
#include "framework/engines/timewarp/trace_watch.h"

namespace tumble::engines {

// changes of virtual times that are kept for the chart
constexpr std::size_t kMostTaughtMoves = 50000;

/// An executed event, until it is committed or rolled back.
struct Executed {
  Effect effect;
  EventStamp key;
  Event first;
  std::vector<Event> more;
  bool is_silent;                     // no event is recorded
  std::set<int> rolled_back{};        // the processes that have rolled it back
  std::unique_ptr<RunWatch> noted{};  // of its discontinuity
};

class TaughtTimewarp {
 public:
  TaughtTimewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                 TrajectorySink& sink, const Trajectory& reference);
  void run();

 private:
  const FlightWorld& world() const { return run_.world(); }
  TaughtLogicalProcess& process(int body) { return processes_[static_cast<std::size_t>(body)]; }
  const Flight& flight_of(int body) {
    return world().can_move(body) ? process(body).flight() : world().first_flight(body);
  }
  double local_time(int body) {
    return world().can_move(body) ? process(body).local_time()
                                  : std::numeric_limits<double>::infinity();
  }
  std::string name(const EventStamp& key) const;
  Box box(int body) {
    return world().can_move(body) ? process(body).swept() : boxes_[static_cast<std::size_t>(body)];
  }
  std::string name(int body) const {
    return body < 0 || body >= world().size()
               ? fmt::format("body {}", body)
               : "'" + world().world().bodies[static_cast<std::size_t>(body)].name + "'";
  }

  void loop();
  std::optional<int> next_due();
  std::optional<double> waits_for(int id);
  std::size_t most_events_at_one_gvt() const;
  void work_at(int id);
  void redraw(int id);
  const KeptState& state_at(int body, double t);
  void check(int id);
  void collide(int id, const FoundImpact& found, const CheckDecision& decision);
  void check_group(int id);
  void call(int id);
  void go_to(int body, double t, std::optional<std::uint32_t> version, const std::string& why);
  void begin_flights(Discontinuity discontinuity, double safe_time, double time);
  void ask_for_groups(const std::vector<BegunFlight>& begun);
  void keep_group_checks(double safe_time = kUnset, double time = kUnset);
  void expect_callback(const EventStamp& key);
  std::vector<LocalTime> local_times() const;

  // The end of the run is a check time, too: without it an impact before the end would be missed
  // where the next check is due after it.
  double due(const ScheduledEvent& check) const {
    return check.safe_time < run_.duration() ? std::min(check.stamp.time, run_.duration())
                                             : check.stamp.time;
  }
  void put_check(int id, ScheduledEvent check) {
    check.stamp.time = due(check);
    queue_.put(id, check);
  }

  // By whole steps, past t where they do not fit: optimistic execution.
  void integrate(int body, double t) {
    while (process(body).local_time() < t) step_to(body, process(body).local_time() + run_.step());
  }
  void step_to(int body, double to);
  void find_pairs(int body, double from);
  void drop_pairs_of(int body);

  void roll_back(const std::vector<Rollback>& first, const std::string& why);
  void roll_back_one(const Rollback& rollback, const std::string& why);

  void look_at_gvt(bool is_over);
  void stand(double until);
  void check_nothing_leaked();
  void commit();
  void commit_event();
  void commit_frame();
  void purge();
  // The sink may show moves while they are made. All are handed over each time, so that times grow
  // apart as their number does.
  void tell_moves() {
    if (times_.moves.size() < told_moves_ + 8 + told_moves_ / 64) return;
    told_moves_ = times_.moves.size();
    sink_.virtual_times(times_);
  }
  void move(int body, double from, double to) {
    if (times_.moves.size() < kMostTaughtMoves)
      times_.moves.push_back({place_[static_cast<std::size_t>(body)], from, to, gvt_});
    else
      times_.is_cut = true;
  }

  TraceWatch watch_;
  FlightRun run_;
  TrajectorySink& sink_;
  Scheduling decide_;
  FrameTimes redraws_;
  std::vector<TaughtLogicalProcess> processes_;  // by body; unused for walls
  std::vector<Box> boxes_;                       // by body; used for walls
  std::vector<int> place_;                       // by body: index among the processes
  std::vector<std::uint32_t> next_version_ =
      std::vector<std::uint32_t>(static_cast<std::size_t>(world().size()), 1);
  TaughtQueue queue_;
  std::map<std::pair<int, int>, int> pairs_;  // pairs with overlapping boxes, to their check
  // current segments that may end by themselves, to their check
  std::map<int, int> groups_;
  std::vector<Executed> executed_;
  VirtualTimes times_;
  std::size_t told_moves_ = 0;  // how many of them the sink has had
  double gvt_ = 0.0;            // global virtual time [s]
  // the last committed item, frame or event
  Stamp committed_{-1.0, 0, WorkKind::kCallback, -1, -1};
  EventStamp committed_key_{-1.0, 0, StampKind::kCallback, -1, -1};  // the last committed event
  double drawn_until_ = -1.0;                    // redraws up to this time were at the front [s]
  std::size_t since_gvt_ = 0, since_asked_ = 0;  // events
};

}  // namespace tumble::engines
