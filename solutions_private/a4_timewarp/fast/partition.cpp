#include "solutions_private/a4_timewarp/fast/partition.h"

#include <algorithm>
#include <span>

namespace tumble::a4 {
namespace {

using engines::Box;

// measured on a gas of 10^5 balls: 3,000 and 12,000 are slower by 10 %, one region by 33 %
constexpr int kBodiesPerRegion = 6000;
constexpr int kMostRegions = 64;
// of both cuts: with each the search for partners looks into more grids
constexpr int kMostPieces = 128;
// above, the axis is the longest one: bodies in the plane are few, and sorting by each axis is dear
constexpr std::size_t kComparesAxes = 10'000;

double work_of(std::span<const WorkLoad> work_loads) {
  double sum = 0.0;
  for (const WorkLoad& work_load : work_loads) sum += work_load.work;
  return sum;
}

void sort_along(int axis, std::span<WorkLoad> work_loads) {
  std::sort(work_loads.begin(), work_loads.end(), [axis](const WorkLoad& a, const WorkLoad& b) {
    return a.middle(axis) < b.middle(axis);
  });
}

// Of bodies that are sorted along the axis: how many lie below the cut, and its place.
struct Cut {
  std::size_t below;
  double place;  // [m]
};
Cut cut_along(int axis, std::span<const WorkLoad> sorted, double work_below) {
  std::size_t below = 0;
  double sum = 0.0;
  while (below + 1 < sorted.size() && sum + 0.5 * sorted[below].work < work_below)
    sum += sorted[below++].work;
  const double above_m = sorted[below].middle(axis);
  return {below, below > 0 ? 0.5 * (sorted[below - 1].middle(axis) + above_m) : above_m};
}

double work_in_plane(int axis, double place, std::span<const WorkLoad> work_loads) {
  double sum = 0.0;
  for (const WorkLoad& work_load : work_loads)
    if (work_load.box_world.low[axis] < place && place <= work_load.box_world.high[axis])
      sum += work_load.work;
  return sum;
}

int longest_axis(std::span<const WorkLoad> work_loads) {
  Box around;  // all middles
  for (const WorkLoad& work_load : work_loads) {
    const Vector3d middle = 0.5 * (work_load.box_world.low + work_load.box_world.high);
    around.take_in({middle, middle});
  }
  int axis = 0;
  (around.high - around.low).maxCoeff(&axis);
  return axis;
}

// The axis with the least work in the planes; of equal ones the longest.
template <class WorkInPlanes>
int best_axis(std::span<const WorkLoad> work_loads, const WorkInPlanes& work_in_planes) {
  const int longest = longest_axis(work_loads);
  if (work_loads.size() > kComparesAxes) return longest;
  int best = longest;
  double least = work_in_planes(longest);
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == longest) continue;
    const double work = work_in_planes(axis);
    if (work < least) {
      least = work;
      best = axis;
    }
  }
  return best;
}

void cut(std::span<WorkLoad> work_loads, const Box& room, int count, std::vector<Box>& regions) {
  if (count == 1) return regions.push_back(room);
  const int lower_count = count / 2;
  int axis = 0;
  Cut at{0, 0.0};
  if (!work_loads.empty()) {
    const double work_below = work_of(work_loads) * lower_count / count;
    axis = best_axis(work_loads, [&](int along) {
      sort_along(along, work_loads);
      return work_in_plane(along, cut_along(along, work_loads, work_below).place, work_loads);
    });
    sort_along(axis, work_loads);
    at = cut_along(axis, work_loads, work_below);
  }
  // Both halves are cut further.
  at.place = std::clamp(at.place, room.low[axis], room.high[axis]);
  Box lower = room, upper = room;
  lower.high[axis] = upper.low[axis] = at.place;
  cut(work_loads.subspan(0, at.below), lower, lower_count, regions);
  cut(work_loads.subspan(at.below), upper, count - lower_count, regions);
}

std::vector<double> places_of_slabs(int axis, int count, std::span<WorkLoad> work_loads) {
  sort_along(axis, work_loads);
  const double work = work_of(work_loads);
  std::vector<double> places;
  for (int k = 1; k < count; ++k) {
    const double place = cut_along(axis, work_loads, work * k / count).place;
    places.push_back(places.empty() ? place : std::max(place, places.back()));
  }
  return places;
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

int slabs_for(int regions, int threads) {
  return threads > 1 && (regions + 1) * (threads + 1) <= kMostPieces ? threads : 0;
}

std::vector<Box> partition_space(std::vector<WorkLoad> work_loads, int count) {
  std::vector<Box> regions;
  cut(work_loads, all_space(), count, regions);
  return regions;
}

std::vector<Box> slabs_of_space(std::vector<WorkLoad> work_loads, int count) {
  int axis = 0;
  std::vector<double> places(static_cast<std::size_t>(count - 1), 0.0);
  if (!work_loads.empty()) {
    axis = best_axis(work_loads, [&](int along) {
      double work = 0.0;
      for (const double place : places_of_slabs(along, count, work_loads))
        work += work_in_plane(along, place, work_loads);
      return work;
    });
    places = places_of_slabs(axis, count, work_loads);
  }
  std::vector<Box> slabs(static_cast<std::size_t>(count), all_space());
  for (std::size_t k = 0; k < places.size(); ++k)
    slabs[k].high[axis] = slabs[k + 1].low[axis] = places[k];
  return slabs;
}

}  // namespace tumble::a4
