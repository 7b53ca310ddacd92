/// Broad phase: which bodies can come near each other during a step, by their swept boxes.
#pragma once

#include <utility>
#include <vector>

#include "framework/core/math.h"

namespace tumble::collision {

/// Axis-aligned box around the volume that a body sweeps in a step. World frame.
struct SweptBox {
  Vector3d low, high;  // [m]
  bool can_move;       // two bodies that cannot move are not a pair
};

/// Pairs (i, j), i < j, of overlapping or touching boxes, at least one of which can move; sorted.
/// Cost: O(n log n + pairs) where boxes are of similar size or few are large; infinite boxes are
/// tested against every other box.
std::vector<std::pair<int, int>> overlapping_pairs(const std::vector<SweptBox>& boxes);

/// The same pairs of boxes that are asked for again and again while they move a little: those that
/// come near each other are kept, until a box has left the room about where it was.
class NearBoxes {
 public:
  /// overlapping_pairs(boxes).
  /// @param boxes  always as many, in the same order
  std::vector<std::pair<int, int>> overlapping_pairs(const std::vector<SweptBox>& boxes);

 private:
  bool are_near(const std::vector<SweptBox>& boxes) const;

  std::vector<SweptBox> rooms_;             // about the boxes
  std::vector<std::pair<int, int>> pairs_;  // of rooms that overlap
  int served_ = 0;                          // questions answered by these pairs
  int unused_ = 0;                          // questions to wait until pairs are kept again
};

}  // namespace tumble::collision
