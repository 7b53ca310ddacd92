/// Words on stderr about a run that takes long: how far it is, how long it will take, and whether it stands still.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "framework/trajectory/trajectory.h"

namespace tumble {

/// Hands everything on to another sink. A run of less than `first_s` says nothing; then there is a line every `every_s`, also while no
/// frame comes: a run that stands still says where.
class RunProgress final : public TrajectorySink {
 public:
  struct Pace {
    double first_s = 5.0, every_s = 10.0;   // of wall clock
  };
  /// @param duration_s  of the run, simulated
  RunProgress(TrajectorySink& sink, double duration_s, Pace pace);
  RunProgress(TrajectorySink& sink, double duration_s) : RunProgress(sink, duration_s, Pace{}) {}
  ~RunProgress() override;
  RunProgress(const RunProgress&) = delete;
  RunProgress& operator=(const RunProgress&) = delete;

  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override { sink_.begin(info, bodies); }
  void frame(const Frame& frame) override;
  void event(const Event& event) override { sink_.event(event); }
  void end(const Counters& counters, const std::string& stopped_by) override { sink_.end(counters, stopped_by); }
  void virtual_times(const VirtualTimes& times) override { sink_.virtual_times(times); }

 private:
  using Clock = std::chrono::steady_clock;
  void tell_until_done();
  void tell(double now_s);

  TrajectorySink& sink_;
  double duration_;                      // [s]
  Pace pace_;
  Clock::time_point begun_ = Clock::now();
  std::mutex mutex_;                     // of what follows
  std::condition_variable ended_;
  bool is_over_ = false;
  double time_ = 0.0, came_s_ = 0.0;     // of the last frame: simulated, and when it came
  double told_time_ = -1.0;              // simulated, in the last line
  std::thread teller_;
};

}  // namespace tumble
