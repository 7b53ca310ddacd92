/// Ctrl-C during a run ends it at its next frame, so that what was simulated is kept, or at its
/// next beat before the first frame.
#pragma once

#include <signal.h>

#include "framework/trajectory/passing_sink.h"

namespace tumble::cli {

/// Thrown out of an engine by the sink below.
struct StoppedByHand {};

/// Passes everything on to another sink until somebody presses Ctrl-C: then the next frame ends the
/// run by StoppedByHand. A second Ctrl-C ends the program at once. One at a time.
class StopByHand final : public PassingSink {
 public:
  explicit StopByHand(TrajectorySink& sink);
  ~StopByHand() override;
  StopByHand(const StopByHand&) = delete;
  StopByHand& operator=(const StopByHand&) = delete;

  /// Whether Ctrl-C was pressed.
  static bool is_asked();

  void frame(const Frame& frame) override;
  void beat(double time_s) override;

 private:
  struct sigaction before_ {};
};

}  // namespace tumble::cli
