/// The state queues of timewarp: the flights of every body from global virtual time on, oldest
/// first, in ring buffers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "framework/core/large_pages.h"
#include "framework/engines/events/flight.h"

namespace tumble::engines {

/// The flights of one body. The first contains global virtual time, the last its local virtual
/// time.
class FlightHistory {
 public:
  std::size_t size() const { return count_; }
  /// Flights for which memory is reserved.
  std::size_t held() const { return mask_ + 1; }
  const Flight& operator[](std::size_t k) const { return slots_[(first_ + k) & mask_]; }
  const Flight& back() const { return (*this)[count_ - 1]; }
  /// Index of the flight with this version; size() where it has been dropped.
  std::size_t find(std::uint32_t version) const {
    for (std::size_t k = count_; k-- > 0;)
      if ((*this)[k].version == version) return k;
    return count_;
  }
  /// Index of the flight at time t. @pre the first flight began at t or before
  std::size_t at(double t) const {
    std::size_t k = count_ - 1;
    while (k > 0 && (*this)[k].begin > t) --k;
    return k;
  }

 private:
  friend class FlightHistories;
  Flight* slots_ = nullptr;
  std::size_t first_ = 0, count_ = 0, mask_ = 0;
};

/// Two threads may push and drop the flights of two bodies concurrently.
class FlightHistories {
 public:
  explicit FlightHistories(std::size_t bodies)
      : histories_(bodies), grown_(bodies), slab_(bodies * kFirstSlots) {
    for (std::size_t i = 0; i < bodies; ++i) {
      histories_[i].slots_ = &slab_[i * kFirstSlots];
      histories_[i].mask_ = kFirstSlots - 1;
    }
  }

  const FlightHistory& operator[](int body) const {
    return histories_[static_cast<std::size_t>(body)];
  }

  /// Prefetches the flights of a body.
  void fetch(int body) const {
    __builtin_prefetch(&histories_[static_cast<std::size_t>(body)]);
    const char* slots =
        reinterpret_cast<const char*>(&slab_[static_cast<std::size_t>(body) * kFirstSlots]);
    for (std::size_t at = 0; at < kFirstSlots * sizeof(Flight); at += 64)
      __builtin_prefetch(slots + at);
  }

  void push(int body, const Flight& flight) {
    FlightHistory& history = histories_[static_cast<std::size_t>(body)];
    if (history.count_ == history.mask_ + 1)
      resize(static_cast<std::size_t>(body), 2 * (history.mask_ + 1));
    history.slots_[(history.first_ + history.count_++) & history.mask_] = flight;
  }
  /// Drops the last flight: a rollback.
  void pop(int body) { --histories_[static_cast<std::size_t>(body)].count_; }
  /// Drops flights that ended before t (fossil collection): nothing before global virtual time is
  /// queried again.
  void purge(int body, double t) {
    purge(body, t, [](const Flight&, const Flight&) {});
  }
  /// Calls `purged(flight, the next one)` for each.
  template <class Purged>
  void purge(int body, double t, const Purged& purged) {
    FlightHistory& history = histories_[static_cast<std::size_t>(body)];
    while (history.count_ > 1 && history[1].begin < t) {
      purged(history[0], history[1]);
      history.first_ = (history.first_ + 1) & history.mask_;
      --history.count_;
    }
    // At a quarter of its capacity the buffer is halved: a burst of events does not reserve memory
    // for the rest of the run.
    if (history.mask_ + 1 > kFirstSlots && 4 * history.count_ <= history.mask_ + 1)
      resize(static_cast<std::size_t>(body), std::max(kFirstSlots, (history.mask_ + 1) / 2));
  }

 private:
  static constexpr std::size_t kFirstSlots = 2;  // a power of two

  void resize(std::size_t body, std::size_t slots) {
    FlightHistory& history = histories_[body];
    std::unique_ptr<Flight[]> own;
    Flight* place = &slab_[body * kFirstSlots];
    if (slots > kFirstSlots) {
      own = std::make_unique_for_overwrite<Flight[]>(slots);
      place = own.get();
    }
    for (std::size_t k = 0; k < history.count_; ++k) place[k] = history[k];
    grown_[body] = std::move(own);
    history.slots_ = place;
    history.first_ = 0;
    history.mask_ = slots - 1;
  }

  std::vector<FlightHistory, LargePages<FlightHistory>> histories_;
  std::vector<std::unique_ptr<Flight[]>> grown_;
  std::vector<Flight, LargePages<Flight>> slab_;
};

}  // namespace tumble::engines
