/// What events on processes began: of each its key and every flight that began with it, so that dropping one of them drops all.
///
/// Threads share it: what it says of a change stands still from when all its flights have begun until the last of them is gone.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "framework/core/stable_table.h"
#include "framework/engines/events/flight.h"

namespace tumble::a4 {

class Changes {
 public:
  /// @return its number
  int add(const engines::EventKey& key) {
    const std::lock_guard lock(mutex_);
    const int number = changes_.take();
    changes_[number] = {key, {}, 0};
    return number;
  }
  void note(int change, int body, std::uint32_t serial) {
    Change& known = changes_[change];
    known.began.emplace_back(body, serial);
    ++known.holders;
  }
  const engines::EventKey& key(int change) const { return changes_[change].key; }
  /// Bodies, and serials of the flights that it began on them.
  const std::vector<std::pair<int, std::uint32_t>>& began(int change) const { return changes_[change].began; }
  /// One of its flights is gone: once a flight.
  void release(int change) {
    const std::lock_guard lock(mutex_);
    if (--changes_[change].holders == 0) changes_.give_back(change);
  }
  /// Changes of which flights are left.
  std::size_t alive() const { return changes_.taken(); }

 private:
  struct Change {
    engines::EventKey key{};
    std::vector<std::pair<int, std::uint32_t>> began;
    int holders = 0;
  };
  StableTable<Change> changes_;
  std::mutex mutex_;
};

}  // namespace tumble::a4
