/// Which part of the room is whose: one box a thread, with about the same work in each.
#pragma once

#include <vector>

#include "framework/engines/timewarp/active_pairs.h"

namespace tumble::a4 {

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
