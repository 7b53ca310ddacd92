#include "framework/trajectory/trajectory.h"

namespace tumble {

void TrajectoryRecorder::begin(const TrajectoryInfo& info,
                               const std::vector<TrajectoryBody>& bodies) {
  trajectory_ = {};
  trajectory_.info = info;
  trajectory_.bodies = bodies;
}

void TrajectoryRecorder::end(const Counters& counters, const std::string& stopped_by) {
  trajectory_.counters = counters;
  trajectory_.stopped_by = stopped_by;
}

}  // namespace tumble
