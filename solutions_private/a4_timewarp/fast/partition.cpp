#include "solutions_private/a4_timewarp/fast/partition.h"

#include <algorithm>
#include <limits>
#include <span>

namespace tumble::a4 {
namespace {

using engines::Box;

// measured on a gas of 10^5 balls: 3,000 and 12,000 are slower by 10 %, one region by 33 %
constexpr int kBodiesPerRegion = 6000;
constexpr int kMostRegions = 64;

void cut(std::span<WorkLoad> work_loads, const Box& room, int count, std::vector<Box>& regions) {
  if (count == 1) return regions.push_back(room);
  Box around;
  double all = 0.0;
  for (const WorkLoad& work_load : work_loads) {
    around.take_in({work_load.middle_world, work_load.middle_world});
    all += work_load.work;
  }
  // Cuts where half of the work is on each side, across the longest axis of the bodies.
  int axis = 0;
  double place = 0.0;
  std::size_t below = 0;
  const int lower_count = count / 2;
  if (!work_loads.empty()) {
    (around.high - around.low).maxCoeff(&axis);
    std::sort(work_loads.begin(), work_loads.end(), [axis](const WorkLoad& a, const WorkLoad& b) {
      return a.middle_world[axis] < b.middle_world[axis];
    });
    double sum = 0.0;
    while (below + 1 < work_loads.size() &&
           sum + 0.5 * work_loads[below].work < all * lower_count / count)
      sum += work_loads[below++].work;
    place = below > 0 ? 0.5 * (work_loads[below - 1].middle_world[axis] +
                               work_loads[below].middle_world[axis])
                      : work_loads[0].middle_world[axis];
  }
  // Both halves are cut further.
  place = std::clamp(place, room.low[axis], room.high[axis]);
  Box lower = room, upper = room;
  lower.high[axis] = upper.low[axis] = place;
  cut(work_loads.subspan(0, below), lower, lower_count, regions);
  cut(work_loads.subspan(below), upper, count - lower_count, regions);
}

}  // namespace

int regions_for(const engines::FlightWorld& world, const engines::RunOptions& options) {
  const engines::FaultInjection& faults = options.faults;
  if (faults.regions > 0) return std::max(faults.regions, options.threads);
  const bool is_of_one_queue =
      faults.disorder_s > 0 || faults.rollback_every > 0 || faults.late_callbacks;
  if (is_of_one_queue || world.processes()) return options.threads;
  const int wanted =
      std::min(kMostRegions, static_cast<int>(world.movers().size()) / kBodiesPerRegion);
  return std::max(1, wanted / options.threads) * options.threads;
}

std::vector<Box> partition_space(std::vector<WorkLoad> work_loads, int count) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  std::vector<Box> regions;
  cut(work_loads, {Vector3d::Constant(-kEnd), Vector3d::Constant(kEnd)}, count, regions);
  return regions;
}

}  // namespace tumble::a4
