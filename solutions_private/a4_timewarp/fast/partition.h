/// Which part of the room is whose: one box a thread, or several, with about the same work in each.
#pragma once

#include <vector>

#include "framework/engines/events/flight_world.h"
#include "framework/engines/base/run_options.h"
#include "framework/engines/timewarp/active_pairs.h"

namespace tumble::a4 {

/// How many there are: as many as threads, and a multiple of that where there are so many bodies that looking at them in the order of events
/// would bring each from memory each time. What is done in one territory, for a while, stays in the nearer caches.
int territories_for(const engines::FlightWorld& world, const engines::RunOptions& options);

/// Where a body is, and what it has cost of late.
struct Burden {
  Vector3d middle_world;   // [m]
  double work;             // in any unit, >= 0
};

/// Cuts the room across its longest side, again and again.
/// @param count  of boxes, >= 1
/// @return boxes that share no point of their insides and fill all space
/// Source: M. Berger, S. Bokhari, "A partitioning strategy for nonuniform problems on multiprocessors", IEEE Transactions on Computers 36, 1987.
std::vector<engines::Box> cut_into_territories(std::vector<Burden> burdens, int count);

/// Whether a box lies in a territory and touches none of its neighbours'.
inline bool holds(const engines::Box& territory, const engines::Box& box) {
  return (territory.low.array() <= box.low.array()).all() && (box.high.array() < territory.high.array()).all();
}

}  // namespace tumble::a4
