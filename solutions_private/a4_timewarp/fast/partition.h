/// The partition of space: one box per thread, or several, with about the same work in each.
#pragma once

#include <vector>

#include "framework/engines/events/flight_world.h"
#include "framework/engines/base/run_options.h"
#include "framework/engines/timewarp/active_pairs.h"

namespace tumble::a4 {

/// The number of regions: that of threads, or a multiple of it for very many bodies, whose entries
/// would otherwise come from main memory at each event. The working set of one region stays in the
/// nearer caches.
int regions_for(const engines::FlightWorld& world, const engines::RunOptions& options);

/// The position of a body and its recent cost.
struct WorkLoad {
  Vector3d middle_world;  // [m]
  double work;            // in any unit, >= 0
};

/// Cuts space across its longest side, recursively.
/// @param count  of boxes, >= 1
/// @return boxes with disjoint interiors that fill all space
/// Source: M. Berger, S. Bokhari, "A partitioning strategy for nonuniform problems on
/// multiprocessors", IEEE Transactions on Computers 36, 1987.
std::vector<engines::Box> partition_space(std::vector<WorkLoad> work_loads, int count);

/// Whether a box lies inside a region.
inline bool holds(const engines::Box& region, const engines::Box& box) {
  return (region.low.array() <= box.low.array()).all() &&
         (box.high.array() < region.high.array()).all();
}

}  // namespace tumble::a4
