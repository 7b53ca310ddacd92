/// The times of a run's frames: multiples of the frame time, the instants that the run is asked for
/// beside them, and the run's end.
#pragma once

#include <vector>

namespace tumble::engines {

struct RunOptions;

class FrameTimes {
 public:
  /// @param instants_s  beside the multiples, in any order; those outside of (0, duration), and
  ///   those that a frame stands for already (kSameInstant), are left out
  FrameTimes(double rate_hz, double duration_s, std::vector<double> instants_s = {});
  /// @param duration_s  where the options name none
  FrameTimes(const RunOptions& options, double duration_s);

  /// The first one that is not taken yet; infinite behind the last. [s]
  double next() const { return next_; }
  void take();
  /// Times that rounding alone parts lie nearer to each other. [s]
  double slack() const { return slack_; }

 private:
  double rate_, duration_, slack_, same_;
  std::vector<double> instants_;  // ascending
  std::size_t taken_instants_ = 0;
  long multiple_ = 0;  // the first that is later than next_
  double next_ = 0.0;
};

}  // namespace tumble::engines
