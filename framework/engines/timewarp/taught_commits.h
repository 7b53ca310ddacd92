/// What the teaching timewarp has executed and is not certain yet: an event is rolled back, or it
/// and the frames between are committed, in the scheduler's order and behind global virtual time.
#pragma once

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "framework/engines/timewarp/taught_processes.h"

namespace tumble::engines {

class TaughtCommits {
 public:
  TaughtCommits(FlightRun& run, const Scheduling& decide, const TaughtProcesses& processes)
      : run_(run), decide_(decide), processes_(processes) {}

  /// An event has been executed. @param processes  on which it has begun flights
  void add(Discontinuity discontinuity, std::vector<std::int32_t> processes);
  /// All processes have reached this time: frames up to it can be drawn. [s]
  void draw_until(double t) { drawn_until_ = std::max(drawn_until_, t); }
  std::vector<Effect> effects() const;

  /// A process goes back: the events that it cancels are marked.
  /// @throws StoppedRun where it goes behind what is committed
  void cancel(const Rollback& rollback, const std::string& why);
  /// Forgets the events that all their processes have rolled back.
  /// @return the callbacks among them, which are pending again
  std::vector<EventStamp> forget_cancelled();

  /// Commits what the scheduler says is certain.
  /// @throws StoppedRun at an event that comes too late or is half rolled back, or a frame that
  ///   cannot be drawn
  void commit();
  /// @throws StoppedRun at the end of a run where something is not committed
  void require_nothing_left() const;
  double committed_until() const { return committed_.time; }  // the last item, event or frame [s]

 private:
  struct Executed {
    Effect effect;
    EventStamp key;
    Event first;
    std::vector<Event> more;
    bool is_silent;                     // no event is recorded
    std::unique_ptr<RunWatch> noted{};  // of its discontinuity
    std::set<int> rolled_back{};        // the processes that have rolled it back
  };
  void commit_event();
  void commit_frame();

  FlightRun& run_;
  const Scheduling& decide_;
  const TaughtProcesses& processes_;
  std::vector<Executed> executed_;
  Stamp committed_{-1.0, 0, WorkKind::kCallback, -1, -1};            // the last item
  EventStamp committed_key_{-1.0, 0, StampKind::kCallback, -1, -1};  // the last event
  double drawn_until_ = -1.0;
};

}  // namespace tumble::engines
