/// A partition of 0 .. n-1 into disjoint sets (union-find); each set is named by its smallest
/// member.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace tumble {

/// Not Boost's disjoint_sets: its ranks choose the name of a set, so the sets must be normalised
/// before a name can be relied on.
class DisjointSets {
 public:
  explicit DisjointSets(int size) : parent_(static_cast<std::size_t>(size)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  /// The smallest member of the set of i. Cost: O(log n), amortised (path halving)
  int find(int i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  void unite(int a, int b) {
    a = find(a);
    b = find(b);
    parent(std::max(a, b)) = std::min(a, b);
  }

 private:
  int& parent(int i) { return parent_[static_cast<std::size_t>(i)]; }

  std::vector<int> parent_;
};

}  // namespace tumble
