/// The records of events on processes: the stamp of each, and every flight that began with it, so
/// that dropping one of them drops all.
///
/// Threads share the records: a record does not change from when all its flights have begun until
/// the last of them is dropped.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "framework/core/stable_table.h"
#include "framework/engines/events/flight.h"

namespace tumble::a4 {

class Changes {
 public:
  /// @return its index
  int add(const engines::EventStamp& key) {
    const std::lock_guard lock(mutex_);
    const int number = changes_.take();
    changes_[number] = {key, {}, 0};
    return number;
  }
  void note(int change, int body, std::uint32_t version) {
    Change& known = changes_[change];
    known.began.emplace_back(body, version);
    ++known.holders;
  }
  const engines::EventStamp& key(int change) const { return changes_[change].key; }
  /// Bodies, and versions of the flights that began on them.
  const std::vector<std::pair<int, std::uint32_t>>& began(int change) const {
    return changes_[change].began;
  }
  /// One of its flights has been dropped. Called once for each flight.
  void release(int change) {
    const std::lock_guard lock(mutex_);
    if (--changes_[change].holders == 0) changes_.give_back(change);
  }
  /// Records with flights left.
  std::size_t alive() const { return changes_.taken(); }

 private:
  struct Change {
    engines::EventStamp key{};
    std::vector<std::pair<int, std::uint32_t>> began;
    int holders = 0;
  };
  StableTable<Change> changes_;
  std::mutex mutex_;
};

}  // namespace tumble::a4
