/// Which checks the queue of the teaching timewarp holds: one of each pair whose swept boxes
/// overlap, and one of each current segment that may end by itself.
#pragma once

#include <map>
#include <utility>

#include "framework/engines/base/run_counters.h"
#include "framework/engines/timewarp/taught_processes.h"
#include "framework/engines/timewarp/taught_queue.h"

namespace tumble::engines {

class TaughtPairChecks {
 public:
  TaughtPairChecks(const TaughtProcesses& processes, TaughtQueue& queue, RunCounters& counters)
      : processes_(processes), queue_(queue), counters_(counters) {}

  std::size_t size() const { return checks_.size(); }
  /// Whether this is the check of the pair, whose boxes still overlap.
  bool holds(int id, int a, int b) const;
  /// A body has advanced from a time: pairs whose boxes begin to overlap get a check. It starts at
  /// the step that made them overlap: nothing is known from there, and beyond the other's swept
  /// box.   Cost: O(n)
  void find(int body, double from);
  /// The box of a body has shrunk: pairs that no longer overlap lose theirs.
  void drop(int body);

 private:
  const TaughtProcesses& processes_;
  TaughtQueue& queue_;
  RunCounters& counters_;
  std::map<std::pair<int, int>, int> checks_;  // by pair, ascending
};

class TaughtGroupChecks {
 public:
  TaughtGroupChecks(const TaughtProcesses& processes, TaughtQueue& queue)
      : processes_(processes), queue_(queue) {}

  std::size_t size() const { return checks_.size(); }
  /// Segments that processes have begun, or a rollback has restored, get a check; a segment that no
  /// body is on loses it.
  /// @param safe_time, time  of new checks; unset: their members' local virtual time, up to which
  ///   they are verified
  void keep(double safe_time = kUnset, double time = kUnset);

 private:
  const TaughtProcesses& processes_;
  TaughtQueue& queue_;
  std::map<int, int> checks_;  // by segment
};

}  // namespace tumble::engines
