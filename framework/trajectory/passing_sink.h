/// A sink that hands everything on to another one: what derives from it says only what it changes.
#pragma once

#include "framework/trajectory/trajectory.h"

namespace tumble {

class PassingSink : public TrajectorySink {
 public:
  /// @param sink  must outlive this
  explicit PassingSink(TrajectorySink& sink) : sink_(sink) {}

  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override {
    sink_.begin(info, bodies);
  }
  void frame(const Frame& frame) override { sink_.frame(frame); }
  void event(const Event& event) override { sink_.event(event); }
  void end(const Counters& counters, const std::string& stopped_by) override {
    sink_.end(counters, stopped_by);
  }
  void beat(double time_s) override { sink_.beat(time_s); }
  void virtual_times(const VirtualTimes& times) override { sink_.virtual_times(times); }

 protected:
  TrajectorySink& sink_;
};

}  // namespace tumble
