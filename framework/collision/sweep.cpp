#include "framework/collision/sweep.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tumble::collision {
namespace {

// Room about a box on each side, of its size: more makes more pairs, less lasts for fewer steps.
constexpr double kRoom = 0.1;
// Questions to wait until pairs are kept again, where those kept answered none: boxes move fast.
constexpr int kWaitForSlow = 8;

constexpr int kLeaf = 4;  // boxes in a leaf: testing so few is faster than another split

struct Leaf {
  Vector3d low, high;
  int index;
  bool can_move;
};

bool share_a_point(const Vector3d& low_a, const Vector3d& high_a, const Vector3d& low_b,
                   const Vector3d& high_b) {
  // All six comparisons without a branch, because a branch could not be predicted.
  return (low_a.x() <= high_b.x()) & (low_b.x() <= high_a.x()) & (low_a.y() <= high_b.y()) &
         (low_b.y() <= high_a.y()) & (low_a.z() <= high_b.z()) & (low_b.z() <= high_a.z());
}

// A tree of bounding boxes, rebuilt for each query: split in halves along the axis of largest
// extent of the centres.
class BoxTree {
 public:
  BoxTree(std::vector<Leaf>& leaves, std::vector<std::pair<int, int>>& pairs)
      : leaves_(leaves), pairs_(pairs) {
    if (leaves.empty()) return;
    nodes_.reserve(leaves.size());
    build(0, static_cast<int>(leaves.size()));
    within(0);
  }

 private:
  struct Node {
    Vector3d low, high;
    int begin, end;
    int second_child;  // 0: a leaf. The first child follows its parent
    bool can_move;
  };

  int build(int begin, int end) {
    Node node{leaves_[begin].low, leaves_[begin].high, begin, end, 0, false};
    Vector3d first = node.low + node.high, last = first;  // twice the centres
    for (int k = begin; k < end; ++k) {
      const Leaf& leaf = leaves_[k];
      node.low = node.low.cwiseMin(leaf.low);
      node.high = node.high.cwiseMax(leaf.high);
      node.can_move = node.can_move || leaf.can_move;
      const Vector3d middle = leaf.low + leaf.high;
      first = first.cwiseMin(middle);
      last = last.cwiseMax(middle);
    }
    const int at = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return at;
    int axis = 0;
    (last - first).maxCoeff(&axis);
    const int half = (begin + end) / 2;
    std::nth_element(leaves_.begin() + begin, leaves_.begin() + half, leaves_.begin() + end,
                     [axis](const Leaf& a, const Leaf& b) {
                       return a.low[axis] + a.high[axis] < b.low[axis] + b.high[axis];
                     });
    build(begin, half);
    nodes_[at].second_child = build(half, end);
    return at;
  }

  void offer(const Leaf& a, const Leaf& b) {
    if ((a.can_move || b.can_move) && share_a_point(a.low, a.high, b.low, b.high))
      pairs_.emplace_back(std::min(a.index, b.index), std::max(a.index, b.index));
  }

  void within(int n) {
    const Node& node = nodes_[n];
    if (!node.can_move) return;
    if (node.second_child == 0) {
      for (int i = node.begin; i < node.end; ++i)
        for (int j = i + 1; j < node.end; ++j) offer(leaves_[i], leaves_[j]);
      return;
    }
    within(n + 1);
    within(node.second_child);
    between(n + 1, node.second_child);
  }

  void between(int m, int n) {
    const Node &a = nodes_[m], &b = nodes_[n];
    if (!(a.can_move || b.can_move) || !share_a_point(a.low, a.high, b.low, b.high)) return;
    if (a.second_child == 0 && b.second_child == 0) {
      for (int i = a.begin; i < a.end; ++i) {
        if (!share_a_point(leaves_[i].low, leaves_[i].high, b.low, b.high)) continue;
        for (int j = b.begin; j < b.end; ++j) offer(leaves_[i], leaves_[j]);
      }
    } else if (b.second_child == 0 || (a.second_child != 0 && a.end - a.begin >= b.end - b.begin)) {
      between(m + 1, n);
      between(a.second_child, n);
    } else {
      between(m, n + 1);
      between(m, b.second_child);
    }
  }

  std::vector<Leaf>& leaves_;
  std::vector<std::pair<int, int>>& pairs_;
  std::vector<Node> nodes_;
};

// Counting sort by the first index, then an ordinary sort by the second: the pairs of one box are
// few.
std::vector<std::pair<int, int>> sorted(const std::vector<std::pair<int, int>>& pairs,
                                        std::size_t n) {
  std::vector<int> place(n + 1, 0);
  for (const auto& pair : pairs) ++place[pair.first + 1];
  for (std::size_t i = 0; i < n; ++i) place[i + 1] += place[i];
  std::vector<std::pair<int, int>> result(pairs.size());
  for (const auto& pair : pairs) result[place[pair.first]++] = pair;
  for (std::size_t begin = 0; begin < result.size();) {
    std::size_t end = begin + 1;
    while (end < result.size() && result[end].first == result[begin].first) ++end;
    std::sort(result.begin() + static_cast<std::ptrdiff_t>(begin),
              result.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
  }
  return result;
}

// Infinite boxes are kept out of the tree: they would make all their ancestors infinite.
bool is_finite(const SweptBox& box) { return std::isfinite((box.high - box.low).sum()); }

}  // namespace

std::vector<std::pair<int, int>> overlapping_pairs(const std::vector<SweptBox>& boxes) {
  std::vector<std::pair<int, int>> pairs;
  std::vector<Leaf> leaves;
  std::vector<int> infinite;
  leaves.reserve(boxes.size());
  for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
    if (is_finite(boxes[i]))
      leaves.push_back({boxes[i].low, boxes[i].high, i, boxes[i].can_move});
    else
      infinite.push_back(i);
  }
  for (const int i : infinite)
    for (int j = 0; j < static_cast<int>(boxes.size()); ++j) {
      const SweptBox &a = boxes[i], &b = boxes[j];
      if (j == i || (j < i && !is_finite(b)) || !(a.can_move || b.can_move)) continue;
      if (share_a_point(a.low, a.high, b.low, b.high))
        pairs.emplace_back(std::min(i, j), std::max(i, j));
    }
  BoxTree(leaves, pairs);
  return sorted(pairs, boxes.size());
}

bool NearBoxes::are_near(const std::vector<SweptBox>& boxes) const {
  if (boxes.size() != rooms_.size()) return false;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const SweptBox &box = boxes[i], &room = rooms_[i];
    const bool is_inside = (room.low.x() <= box.low.x()) & (room.low.y() <= box.low.y()) &
                           (room.low.z() <= box.low.z()) & (box.high.x() <= room.high.x()) &
                           (box.high.y() <= room.high.y()) & (box.high.z() <= room.high.z());
    if (!is_inside || (box.can_move && !room.can_move)) return false;
  }
  return true;
}

std::vector<std::pair<int, int>> NearBoxes::overlapping_pairs(const std::vector<SweptBox>& boxes) {
  if (are_near(boxes)) {
    ++served_;
  } else {
    const bool was_in_vain = !rooms_.empty() && served_ == 0;
    rooms_.clear();
    if (was_in_vain) unused_ = kWaitForSlow;
    if (unused_ > 0) {
      --unused_;
      return collision::overlapping_pairs(boxes);
    }
    for (const SweptBox& box : boxes) {
      const Vector3d room = kRoom * (box.high - box.low);
      rooms_.push_back({box.low - room, box.high + room, box.can_move});
    }
    pairs_ = collision::overlapping_pairs(rooms_);
    served_ = 0;
  }
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [i, j] : pairs_) {
    const SweptBox &a = boxes[static_cast<std::size_t>(i)], &b = boxes[static_cast<std::size_t>(j)];
    if ((a.can_move || b.can_move) && share_a_point(a.low, a.high, b.low, b.high))
      pairs.emplace_back(i, j);
  }
  return pairs;
}

}  // namespace tumble::collision
