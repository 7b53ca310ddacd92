/// The state queues of timewarp: of every body the flights from global virtual time on, oldest first, in ring buffers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "framework/core/large_pages.h"
#include "framework/engines/events/flight.h"

namespace tumble::engines {

/// One body's flights. The first is the one that global virtual time lies in, the last the one that its local virtual time lies in.
class FlightHistory {
 public:
  std::size_t size() const { return count_; }
  /// Flights that memory is held for.
  std::size_t held() const { return mask_ + 1; }
  const Flight& operator[](std::size_t k) const { return slots_[(first_ + k) & mask_]; }
  const Flight& back() const { return (*this)[count_ - 1]; }
  /// Place of the flight with this serial; size() where it is gone.
  std::size_t find(std::uint32_t serial) const {
    for (std::size_t k = count_; k-- > 0;)
      if ((*this)[k].serial == serial) return k;
    return count_;
  }
  /// Place of the flight that the body is on at time t. @pre the first flight began at t or before
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

/// Two bodies' flights may be pushed and dropped by two threads.
class FlightHistories {
 public:
  explicit FlightHistories(std::size_t bodies) : histories_(bodies), grown_(bodies), slab_(bodies * kFirstSlots) {
    for (std::size_t i = 0; i < bodies; ++i) {
      histories_[i].slots_ = &slab_[i * kFirstSlots];
      histories_[i].mask_ = kFirstSlots - 1;
    }
  }

  const FlightHistory& operator[](int body) const { return histories_[static_cast<std::size_t>(body)]; }

  /// Begins to bring a body's flights from memory.
  void fetch(int body) const {
    __builtin_prefetch(&histories_[static_cast<std::size_t>(body)]);
    const char* slots = reinterpret_cast<const char*>(&slab_[static_cast<std::size_t>(body) * kFirstSlots]);
    for (std::size_t at = 0; at < kFirstSlots * sizeof(Flight); at += 64) __builtin_prefetch(slots + at);
  }

  void push(int body, const Flight& flight) {
    FlightHistory& history = histories_[static_cast<std::size_t>(body)];
    if (history.count_ == history.mask_ + 1) resize(static_cast<std::size_t>(body), 2 * (history.mask_ + 1));
    history.slots_[(history.first_ + history.count_++) & history.mask_] = flight;
  }
  /// Drops the last flight: a rollback.
  void pop(int body) { --histories_[static_cast<std::size_t>(body)].count_; }
  /// Drops flights that ended before t: nothing before global virtual time is asked for again.
  void purge(int body, double t) {
    purge(body, t, [](const Flight&) {});
  }
  /// Calls `purged(flight)` of each.
  template <class Purged>
  void purge(int body, double t, const Purged& purged) {
    FlightHistory& history = histories_[static_cast<std::size_t>(body)];
    while (history.count_ > 1 && history[1].begin < t) {
      purged(history[0]);
      history.first_ = (history.first_ + 1) & history.mask_;
      --history.count_;
    }
    // A quarter full: who once flew much in a short time need not hold the memory for good.
    if (history.mask_ + 1 > kFirstSlots && 4 * history.count_ <= history.mask_ + 1) resize(static_cast<std::size_t>(body), std::max(kFirstSlots, (history.mask_ + 1) / 2));
  }

 private:
  static constexpr std::size_t kFirstSlots = 2;   // a power of two

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
