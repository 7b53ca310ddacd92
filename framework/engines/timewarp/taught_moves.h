/// The moves of local virtual times in a run of the teaching timewarp, for the chart: recorded up
/// to a limit, and shown to the sink while they are made.
#pragma once

#include <vector>

#include "framework/engines/events/flight_world.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

class TaughtMoves {
 public:
  TaughtMoves(const FlightWorld& world, TrajectorySink& sink) : sink_(sink) {
    for (int i = 0; i < world.size(); ++i) {
      place_.push_back(static_cast<int>(times_.processes.size()));
      if (world.can_move(i))
        times_.processes.push_back(world.world().bodies[static_cast<std::size_t>(i)].name);
    }
  }

  void add(int body, double from, double to, double global_virtual_time) {
    if (times_.moves.size() < kMostMoves)
      times_.moves.push_back(
          {place_[static_cast<std::size_t>(body)], from, to, global_virtual_time});
    else
      times_.is_cut = true;
  }
  /// Global virtual time has risen with the last move of all, which need not be recorded.
  void raise(double global_virtual_time) {
    if (!times_.moves.empty() && !times_.is_cut)
      times_.moves.back().global_virtual_time_s = global_virtual_time;
    // All are handed over each time, so that times grow apart as their number does.
    if (times_.moves.size() < told_ + 1 + told_ / 64) return;
    told_ = times_.moves.size();
    end();
  }
  void end() { sink_.virtual_times(times_); }

 private:
  static constexpr std::size_t kMostMoves = 50000;

  TrajectorySink& sink_;
  std::vector<int> place_;  // by body: index among the processes
  VirtualTimes times_;
  std::size_t told_ = 0;  // how many moves the sink has had
};

}  // namespace tumble::engines
