/// What is kept about pairs of bodies between questions about their gaps. Answers are the same
/// without it, bit for bit.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "framework/collision/pair_cache.h"

namespace tumble::engines {

class PairCaches {
 public:
  /// Of these two bodies, in the order in which every question names them. Valid until the next
  /// call.
  collision::PairCache* of(int a, int b) {
    if (known_.size() > kMost) known_.clear();  // pairs of long ago
    return &known_[(static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b)];
  }

 private:
  static constexpr std::size_t kMost = 1 << 13;
  std::unordered_map<std::uint64_t, collision::PairCache> known_;  // never iterated over
};

}  // namespace tumble::engines
