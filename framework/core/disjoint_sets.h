/// Which of n things belong together (union-find), each set named by its smallest member.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace tumble {

/// Boost's disjoint_sets names a set by whichever member its ranks choose, and has to be normalised before its names may be relied on.
class DisjointSets {
 public:
  explicit DisjointSets(int size) : parent_(static_cast<std::size_t>(size)) { std::iota(parent_.begin(), parent_.end(), 0); }

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
