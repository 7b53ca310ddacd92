/// The teaching timewarp: taught_timewarp.cpp has the loop and global virtual time,
/// taught_events.cpp executes events and rolls back. The parts that they act on keep what belongs
/// together, each in a header of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/engines/base/frame_times.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/timewarp/taught_checks.h"
#include "framework/engines/timewarp/taught_commits.h"
#include "framework/engines/timewarp/taught_motion.h"
#include "framework/engines/timewarp/taught_moves.h"
#include "framework/engines/timewarp/taught_processes.h"
#include "framework/engines/timewarp/taught_queue.h"
#include "framework/engines/timewarp/taught_search.h"
#include "framework/engines/timewarp/trace_watch.h"

namespace tumble::engines {

class TaughtTimewarp {
 public:
  TaughtTimewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                 TrajectorySink& sink, const Trajectory& reference);
  void run();

 private:
  // Which event is next, and what is certain.
  void loop();
  std::optional<int> next_due();
  void look_at_gvt(bool is_over);
  void check_nothing_leaked();

  // The events.
  void execute(int id);
  void redraw(int id);
  void check(int id);
  void collide(int id, const FoundImpact& found, const CheckDecision& decision);
  void check_group(int id);
  void expect_callback(const EventStamp& key);
  void call(int id);
  void begin_flights(Discontinuity discontinuity, double safe_time = kUnset, double time = kUnset);
  void roll_back(const std::vector<Rollback>& first, const std::string& why);

  TraceWatch watch_;
  FlightRun run_;
  Scheduling decide_;
  FrameTimes redraws_;
  TaughtQueue queue_;
  TaughtProcesses processes_;
  TaughtPairChecks pairs_;
  TaughtGroupChecks groups_;
  TaughtMoves moves_;
  TaughtMotion motion_;
  TaughtCommits commits_;
  std::size_t since_gvt_ = 0, since_asked_ = 0;  // events
};

}  // namespace tumble::engines
