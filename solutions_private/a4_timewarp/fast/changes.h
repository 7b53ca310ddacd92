/// What events on processes began: of each its key and every flight that began with it, so that dropping one of them drops all.
#pragma once

#include <utility>
#include <vector>

#include "framework/engines/events/flight.h"

namespace tumble::a4 {

class Changes {
 public:
  /// @return its number
  int add(const engines::EventKey& key) {
    if (free_.empty()) {
      free_.push_back(static_cast<int>(changes_.size()));
      changes_.push_back({key, {}, 0});
    }
    const int number = free_.back();
    free_.pop_back();
    changes_[static_cast<std::size_t>(number)] = {key, {}, 0};
    return number;
  }
  void note(int change, int body, std::uint32_t serial) {
    Change& known = changes_[static_cast<std::size_t>(change)];
    known.began.emplace_back(body, serial);
    ++known.holders;
  }
  const engines::EventKey& key(int change) const { return changes_[static_cast<std::size_t>(change)].key; }
  /// Bodies, and serials of the flights that it began on them.
  const std::vector<std::pair<int, std::uint32_t>>& began(int change) const { return changes_[static_cast<std::size_t>(change)].began; }
  /// One of its flights is gone: once a flight.
  void release(int change) {
    if (--changes_[static_cast<std::size_t>(change)].holders == 0) free_.push_back(change);
  }
  /// Changes of which flights are left.
  std::size_t alive() const { return changes_.size() - free_.size(); }

 private:
  struct Change {
    engines::EventKey key;
    std::vector<std::pair<int, std::uint32_t>> began;
    int holders;
  };
  std::vector<Change> changes_;
  std::vector<int> free_;
};

}  // namespace tumble::a4
