/// Broad phase: which bodies can come near each other during a step, by the boxes that they sweep.
#pragma once

#include <utility>
#include <vector>

#include "framework/core/math.h"

namespace tumble::collision {

/// Axis-aligned box around all that a body sweeps in a step. World frame.
struct SweptBox {
  Vector3d low, high;   // [m]
  bool can_move;        // two that cannot are no pair
};

/// Pairs (i, j), i < j, of boxes that share a point, at least one of which can move; sorted.
/// Cost: O(n log n + pairs) where boxes are of similar size or few are large; boxes without end are tried with every other.
std::vector<std::pair<int, int>> overlapping_pairs(const std::vector<SweptBox>& boxes);

}  // namespace tumble::collision
