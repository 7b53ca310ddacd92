/// What is known of pairs of bodies in one step, entered in ascending order: one block of memory
/// instead of a node for each pair.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "framework/core/error.h"

namespace tumble::engines {

template <class Known>
class PairTable {
 public:
  using Pair = std::pair<int, int>;  // bodies, first < second

  bool empty() const { return entries_.empty(); }
  void clear() { entries_.clear(); }
  /// @pre the pair comes after all that have been entered
  void enter(Pair pair, Known known) {
    require(entries_.empty() || entries_.back().first < pair, "pairs are entered in their order");
    entries_.emplace_back(pair, std::move(known));
  }
  /// Null: nothing was entered for the pair.
  const Known* find(Pair pair) const {
    const auto found =
        std::lower_bound(entries_.begin(), entries_.end(), pair,
                         [](const auto& entry, const Pair& p) { return entry.first < p; });
    return found != entries_.end() && found->first == pair ? &found->second : nullptr;
  }
  Known* find(Pair pair) { return const_cast<Known*>(std::as_const(*this).find(pair)); }
  bool contains(Pair pair) const { return find(pair) != nullptr; }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }

 private:
  std::vector<std::pair<Pair, Known>> entries_;
};

}  // namespace tumble::engines
