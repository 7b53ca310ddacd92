/// A queue of events in order of their keys. The caller recognises stale items when they are at the
/// front.
///
/// Events are stored in bins of time, unordered; only the events of the front's bin are in a heap
/// (four children per node). So most events are written once and read once, and the heap stays in
/// the L1 cache for any number of events.
/// Source: R. Brown, "Calendar queues", Communications of the ACM 31, 1988.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tumble::engines {

/// @tparam Item  has a `key` with operator< and a `key.time` that orders first
template <class Item>
class EventQueue {
 public:
  /// @param width  of a bin [s], > 0: about a hundred events should fall into one; infinite: one
  ///   heap for all
  explicit EventQueue(double width = std::numeric_limits<double>::infinity())
      : per_second_(1.0 / width), bins_(per_second_ > 0 ? kBins : 0) {}

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const Item& front() const { return heap_.front(); }

  void push(const Item& item) {
    ++size_;
    const std::int64_t bin = bin_of(item.key.time);
    if (bin <= current_)
      rise(item);
    else if (bin < current_ + kBins)
      put(bin, item);
    else
      far_.push_back(item);
    if (heap_.empty()) go_on();
  }

  /// Removes all items, in any order. @param work  is called with each
  template <class Work>
  void drain(const Work& work) {
    std::vector<Item> all;
    all.swap(heap_);
    all.insert(all.end(), far_.begin(), far_.end());
    far_.clear();
    for (std::vector<Item>& bin : bins_) {
      all.insert(all.end(), bin.begin(), bin.end());
      give_back(bin);
    }
    size_ = 0;
    for (const Item& item : all) work(item);
  }

  /// Visits all items, in any order. @param work  is called with each
  template <class Work>
  void for_each(const Work& work) const {
    for (const Item& item : heap_) work(item);
    for (const Item& item : far_) work(item);
    for (const std::vector<Item>& bin : bins_)
      for (const Item& item : bin) work(item);
  }

  /// Items for which memory is reserved.
  std::size_t held() const {
    std::size_t held = heap_.capacity() + far_.capacity();
    for (const auto* some : {&bins_, &spare_})
      for (const std::vector<Item>& bin : *some) held += bin.capacity();
    return held;
  }

  Item pop() {
    const Item front = heap_.front(), last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) sink(last);
    if (--size_ > 0 && heap_.empty()) go_on();
    return front;
  }

 private:
  // flatter than a binary heap: fewer cache misses per pop
  static constexpr std::size_t kChildren = 4;
  static constexpr std::int64_t kBins = 4096;

  // Never decreases with time, rounding included: an item in a later bin is later.
  std::int64_t bin_of(double time) const {
    return static_cast<std::int64_t>(std::min(std::floor(time * per_second_), 4e18));
  }

  // Advances to the next bin that is not empty.
  void go_on() {
    while (heap_.empty()) {
      if (waiting_near() == 0) current_ = nearest_far() - 1;
      ++current_;
      if (current_ >= turn_) take_in_far();
      std::vector<Item>& bin = bins_[static_cast<std::size_t>(current_ % kBins)];
      for (const Item& item : bin) rise(item);
      give_back(bin);
    }
  }
  void give_back(std::vector<Item>& bin) {
    bin.clear();
    if (bin.capacity() > 0) spare_.push_back(std::move(bin));
  }
  // Empty bins hold no memory; the next bin that needs some reuses it. Otherwise memory would grow
  // for a whole cycle of the bins, which may be an hour of simulated time.
  void put(std::int64_t at, const Item& item) {
    std::vector<Item>& bin = bins_[static_cast<std::size_t>(at % kBins)];
    if (bin.capacity() == 0 && !spare_.empty()) {
      bin.swap(spare_.back());
      spare_.pop_back();
    }
    bin.push_back(item);
  }
  std::size_t waiting_near() const { return size_ - heap_.size() - far_.size(); }
  std::int64_t nearest_far() const {
    std::int64_t nearest = std::numeric_limits<std::int64_t>::max();
    for (const Item& item : far_) nearest = std::min(nearest, bin_of(item.key.time));
    return nearest;
  }
  // Sorts items beyond the cycle into bins, twice per cycle, before the first of them can be due.
  void take_in_far() {
    turn_ = current_ + kBins / 2;
    std::vector<Item> still_far;
    for (const Item& item : far_) {
      const std::int64_t bin = bin_of(item.key.time);
      if (bin < current_ + kBins)
        put(bin, item);
      else
        still_far.push_back(item);
    }
    far_.swap(still_far);
  }

  void rise(const Item& item) {
    std::size_t at = heap_.size();
    heap_.push_back(item);
    while (at > 0) {
      const std::size_t parent = (at - 1) / kChildren;
      if (!(item.key < heap_[parent].key)) break;
      heap_[at] = heap_[parent];
      at = parent;
    }
    heap_[at] = item;
  }

  void sink(const Item& item) {
    const std::size_t count = heap_.size();
    std::size_t at = 0;
    for (;;) {
      const std::size_t first = kChildren * at + 1;
      if (first >= count) break;
      std::size_t least = first;
      for (std::size_t child = first + 1; child < std::min(first + kChildren, count); ++child)
        if (heap_[child].key < heap_[least].key) least = child;
      if (!(heap_[least].key < item.key)) break;
      heap_[at] = heap_[least];
      at = least;
    }
    heap_[at] = item;
  }

  double per_second_;
  // by bin modulo kBins: the bins in (current_, current_ + kBins)
  std::vector<std::vector<Item>> bins_;
  std::vector<std::vector<Item>> spare_;  // memory of bins that are empty now
  std::vector<Item> heap_;                // bins up to current_
  std::vector<Item> far_;                 // beyond
  std::int64_t current_ = 0, turn_ = 0;   // turn_: the bin at which far_ is scanned again
  std::size_t size_ = 0;
};

}  // namespace tumble::engines
