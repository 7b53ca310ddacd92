/// Ctrl-C during a run ends it at its next frame, so that what was simulated is kept.
#pragma once

#include <signal.h>

#include "framework/trajectory/trajectory.h"

namespace tumble::cli {

/// Thrown out of an engine by the sink below.
struct StoppedByHand {};

/// Passes everything on to another sink until somebody presses Ctrl-C: then the next frame ends the
/// run by StoppedByHand. A second Ctrl-C ends the program at once. One at a time.
class StopByHand final : public TrajectorySink {
 public:
  explicit StopByHand(TrajectorySink& sink);
  ~StopByHand() override;
  StopByHand(const StopByHand&) = delete;
  StopByHand& operator=(const StopByHand&) = delete;

  /// Whether Ctrl-C was pressed.
  static bool is_asked();

  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override {
    sink_.begin(info, bodies);
  }
  void frame(const Frame& frame) override;
  void event(const Event& event) override { sink_.event(event); }
  void end(const Counters& counters, const std::string& stopped_by) override {
    sink_.end(counters, stopped_by);
  }
  void virtual_times(const VirtualTimes& times) override { sink_.virtual_times(times); }

 private:
  TrajectorySink& sink_;
  struct sigaction before_ {};
};

}  // namespace tumble::cli
