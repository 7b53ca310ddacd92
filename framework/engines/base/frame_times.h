/// The times of a run's frames: multiples of the frame time, the instants that the scene's checks
/// ask for, and the run's end. Two that rounding alone parts are one.
#pragma once

#include <limits>
#include <vector>

namespace tumble::scene {
struct Scene;
}

namespace tumble::engines {

struct RunOptions;

class FrameTimes {
 public:
  /// @param instants_s  beside the multiples, in any order; those outside of (0, duration) are left
  ///   out
  FrameTimes(double rate_hz, double duration_s, std::vector<double> instants_s = {});
  /// Of a run of the scene: the instants of its checks.
  FrameTimes(const scene::Scene& scene, const RunOptions& options);

  /// The first one that is not taken yet; infinite behind the last. [s]
  double next() const { return next_; }
  void take();
  /// Times that lie nearer to each other are the same instant. [s]
  double slack() const { return slack_; }

 private:
  double rate_, duration_, slack_;
  std::vector<double> instants_;  // ascending
  std::size_t taken_instants_ = 0;
  long multiple_ = 0;  // the first that is later than next_
  double next_ = 0.0;
};

}  // namespace tumble::engines
