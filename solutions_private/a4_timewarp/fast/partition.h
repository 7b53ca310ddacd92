/// Cuts of space: into one box per thread, or several, with about the same work in each; and across
/// that cut, for the bodies that lie in none of these boxes.
#pragma once

#include <limits>
#include <vector>

#include "framework/engines/base/run_options.h"
#include "framework/engines/events/flight_world.h"
#include "framework/engines/timewarp/active_pairs.h"

namespace tumble::a4 {

/// The number of regions: that of threads, or a multiple of it for very many bodies, whose entries
/// would otherwise come from main memory at each event. The working set of one region stays in the
/// nearer caches.
int regions_for(const engines::FlightWorld& world, const engines::RunOptions& options);

/// The number of slabs of the second cut; 0: there is none. One per thread, where the pieces of
/// both cuts are not too many.
int slabs_for(int regions, int threads);

/// The box of a body and its recent cost.
struct WorkLoad {
  engines::Box box_world;  // finite [m]
  double work;             // in any unit, >= 0

  double middle(int axis) const { return 0.5 * (box_world.low[axis] + box_world.high[axis]); }
};

/// Cuts space recursively, each time into two parts of the same work, across the axis on which the
/// bodies in the plane of the cut have the least work.
/// @param count  of boxes, >= 1
/// @return boxes with disjoint interiors that fill all space
/// Source: M. Berger, S. Bokhari, "A partitioning strategy for nonuniform problems on
/// multiprocessors", IEEE Transactions on Computers 36, 1987.
std::vector<engines::Box> partition_space(std::vector<WorkLoad> work_loads, int count);

/// Cuts space into parallel slabs with about the same work in each, across the axis on which the
/// bodies in the planes of the cuts have the least work. For the bodies in the planes of another
/// cut that is an axis along those planes.
/// @param count  of slabs, >= 1
/// @return slabs in order, which fill all space
std::vector<engines::Box> slabs_of_space(std::vector<WorkLoad> work_loads, int count);

inline engines::Box all_space() {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  return {Vector3d::Constant(-kEnd), Vector3d::Constant(kEnd)};
}

/// Whether a box lies inside a region.
inline bool holds(const engines::Box& region, const engines::Box& box) {
  return (region.low.array() <= box.low.array()).all() &&
         (box.high.array() < region.high.array()).all();
}

}  // namespace tumble::a4
