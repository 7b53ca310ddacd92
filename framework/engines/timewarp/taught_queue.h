/// The event queue of the teaching timewarp: in the scheduler's order, whatever that is.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "framework/dynamics/scheduling.h"

namespace tumble::engines {

/// Events by index. A queued event waits for its turn; a parked or popped event is kept, and does
/// not wait.
class TaughtQueue {
 public:
  /// @param duration  of the run [s]
  TaughtQueue(std::function<bool(const Stamp&, const Stamp&)> comes_before, double duration)
      : comes_before_(std::move(comes_before)), duration_(duration) {}

  /// @return its index
  int add(const ScheduledEvent& event) {
    const int id = next_id_++;
    put(id, event);
    return id;
  }
  /// Queues an event with new times, or again: its earlier item in the heap becomes stale.
  void put(int id, const ScheduledEvent& event) {
    Entry& entry = entries_[id];
    entry.event = event;
    heap_.push_back({event.stamp, id, ++entry.version});
    std::push_heap(heap_.begin(), heap_.end(), later());
  }
  /// The same for checks: the end of the run is a check time, too. Without it an impact before the
  /// end would be missed where the next check is due after it.
  int add_check(ScheduledEvent check) {
    check.stamp.time = due(check);
    return add(check);
  }
  void put_check(int id, ScheduledEvent check) {
    check.stamp.time = due(check);
    put(id, check);
  }
  void park(int id) { ++entries_.at(id).version; }
  void remove(int id) { entries_.erase(id); }
  const ScheduledEvent& event(int id) const { return entries_.at(id).event; }
  /// Of all events, with popped and parked ones; ascending.
  std::vector<int> ids() const {
    std::vector<int> ids;
    for (const auto& [id, entry] : entries_) ids.push_back(id);
    return ids;
  }

  /// Removes the front from the queue but keeps the event; nothing where the queue is empty.
  std::optional<int> pop() {
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), later());
      const Item front = heap_.back();
      heap_.pop_back();
      const auto entry = entries_.find(front.id);
      if (entry != entries_.end() && entry->second.version == front.version) return front.id;
    }
    return std::nullopt;
  }

 private:
  struct Entry {
    ScheduledEvent event;
    unsigned version = 0;
  };
  struct Item {
    Stamp stamp;
    int id;
    unsigned version;
  };
  double due(const ScheduledEvent& check) const {
    return check.safe_time < duration_ ? std::min(check.stamp.time, duration_) : check.stamp.time;
  }
  // The standard heap has the largest item in front. With an order that is not a strict weak order
  // it only pops in a wrong order.
  std::function<bool(const Item&, const Item&)> later() const {
    return [this](const Item& x, const Item& y) { return comes_before_(y.stamp, x.stamp); };
  }

  std::function<bool(const Stamp&, const Stamp&)> comes_before_;
  double duration_;
  std::map<int, Entry> entries_;
  std::vector<Item> heap_;
  int next_id_ = 0;
};

}  // namespace tumble::engines
