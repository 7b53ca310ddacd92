/// A queue of events in order of their keys: a heap of small items with four children a node, whose stale items their owner recognises
/// when they come to the front.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace tumble::engines {

/// @tparam Item  has a `key` with operator<
template <class Item>
class EventQueue {
 public:
  bool empty() const { return items_.empty(); }
  std::size_t size() const { return items_.size(); }
  const Item& front() const { return items_.front(); }
  /// In no order that means anything; the first is the front.
  const std::vector<Item>& items() const { return items_; }

  void push(const Item& item) {
    std::size_t at = items_.size();
    items_.push_back(item);
    while (at > 0) {
      const std::size_t parent = (at - 1) / kChildren;
      if (!(item.key < items_[parent].key)) break;
      items_[at] = items_[parent];
      at = parent;
    }
    items_[at] = item;
  }

  Item pop() {
    const Item front = items_.front(), last = items_.back();
    items_.pop_back();
    if (!items_.empty()) sink(last);
    return front;
  }

 private:
  static constexpr std::size_t kChildren = 4;   // flatter than a binary heap: fewer misses of the cache a pop

  void sink(const Item& item) {
    const std::size_t count = items_.size();
    std::size_t at = 0;
    for (;;) {
      const std::size_t first = kChildren * at + 1;
      if (first >= count) break;
      std::size_t least = first;
      for (std::size_t child = first + 1; child < std::min(first + kChildren, count); ++child)
        if (items_[child].key < items_[least].key) least = child;
      if (!(items_[least].key < item.key)) break;
      items_[at] = items_[least];
      at = least;
    }
    items_[at] = item;
  }

  std::vector<Item> items_;
};

}  // namespace tumble::engines
