#include "framework/collision/sweep.h"

#include <algorithm>
#include <numeric>

namespace tumble::collision {
namespace {

// The axis along which the centres vary most separates most pairs.
int widest_axis(const std::vector<SweptBox>& boxes) {
  Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero();
  int counted = 0;
  for (const SweptBox& box : boxes) {
    const Vector3d middle = 0.5 * (box.low + box.high);
    if (!middle.allFinite()) continue;
    sum += middle;
    squares += middle.cwiseAbs2();
    ++counted;
  }
  if (counted == 0) return 0;
  int axis = 0;
  (squares - sum.cwiseAbs2() / counted).maxCoeff(&axis);
  return axis;
}

bool share_a_point(const SweptBox& a, const SweptBox& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

}  // namespace

std::vector<std::pair<int, int>> overlapping_pairs(const std::vector<SweptBox>& boxes) {
  const int axis = widest_axis(boxes);
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    return boxes[i].low[axis] != boxes[j].low[axis] ? boxes[i].low[axis] < boxes[j].low[axis] : i < j;
  });
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const SweptBox& box = boxes[order[k]];
    for (std::size_t m = k + 1; m < order.size() && boxes[order[m]].low[axis] <= box.high[axis]; ++m) {
      const SweptBox& other = boxes[order[m]];
      if ((box.can_move || other.can_move) && share_a_point(box, other))
        pairs.emplace_back(std::min(order[k], order[m]), std::max(order[k], order[m]));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace tumble::collision
