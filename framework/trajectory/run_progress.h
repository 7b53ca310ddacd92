/// Progress of a long run on stderr: how far it is, how long it will take, and whether it has
/// stopped advancing.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "framework/trajectory/passing_sink.h"

namespace tumble {

/// Passes everything on to another sink. Nothing is printed before `first_s`; then a line every
/// `every_s`, also while no frame arrives, so that a run that no longer advances shows at which
/// time.
class RunProgress final : public PassingSink {
 public:
  struct Pace {
    double first_s = 5.0, every_s = 10.0;  // of wall-clock time
    bool rewrites = false;                 // one line of a terminal
  };
  /// For what stderr is: a terminal or a file.
  static Pace usual_pace();
  /// @param duration_s  of the run, simulated
  RunProgress(TrajectorySink& sink, double duration_s, Pace pace);
  RunProgress(TrajectorySink& sink, double duration_s)
      : RunProgress(sink, duration_s, usual_pace()) {}
  ~RunProgress() override;
  RunProgress(const RunProgress&) = delete;
  RunProgress& operator=(const RunProgress&) = delete;

  void frame(const Frame& frame) override;
  void beat(double time_s) override;

 private:
  using Clock = std::chrono::steady_clock;
  void note(double time_s, bool is_of_a_beat);
  void report_until_done();
  void report(double now_s);

  double duration_;  // [s]
  Pace pace_;
  Clock::time_point begun_ = Clock::now();
  std::mutex mutex_;  // guards the members below
  std::condition_variable ended_;
  bool is_over_ = false;
  double time_ = 0.0, came_s_ = 0.0;  // of the last frame or beat: simulated time, and arrival
  bool is_of_a_beat_ = false;         // these are of the work before the first frame
  double reported_time_ = -1.0;       // simulated time in the last line
  std::thread reporter_;
};

}  // namespace tumble
