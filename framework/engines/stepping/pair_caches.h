/// What is kept about pairs of bodies between questions about their gaps. Answers are the same
/// without it, bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "framework/collision/pair_cache.h"

namespace tumble::engines {

class PairCaches {
 public:
  /// Of these two bodies, in the order in which every question names them. Valid until the next
  /// call.
  collision::PairCache* of(int a, int b) {
    const std::uint64_t pair =
        (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b);
    if (!slots_.empty())
      if (const Slot* known = find(pair); known->cache != nullptr) return known->cache;
    if (2 * caches_.size() >= slots_.size()) make_room();
    Slot* slot = find(pair);
    *slot = {pair, &caches_.emplace_back()};
    return slot->cache;
  }

 private:
  // Open addressing: a pair stands at the place that its hash says, or in the next free one after.
  struct Slot {
    std::uint64_t pair = 0;
    collision::PairCache* cache = nullptr;  // null: free
  };

  Slot* find(std::uint64_t pair) {
    constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;  // 2^64 over the golden ratio
    const std::size_t last = slots_.size() - 1;            // the size is a power of two
    std::size_t at = static_cast<std::size_t>((pair * kGolden) >> 32) & last;
    while (slots_[at].cache != nullptr && slots_[at].pair != pair) at = (at + 1) & last;
    return &slots_[at];
  }
  void make_room() {
    if (caches_.size() > kMost) {  // pairs of long ago
      caches_.clear();
      slots_.assign(slots_.size(), {});
      return;
    }
    std::vector<Slot> before(slots_.empty() ? kFirst : 2 * slots_.size());
    before.swap(slots_);
    for (const Slot& slot : before)
      if (slot.cache != nullptr) *find(slot.pair) = slot;
  }

  static constexpr std::size_t kFirst = 16, kMost = (1 << 13) - 1;
  std::vector<Slot> slots_;  // never iterated over for a result
  std::deque<collision::PairCache> caches_;
};

}  // namespace tumble::engines
