/// A logical process of the teaching timewarp: the states of one body from global to local virtual
/// time, and the box that it sweeps between them. Bodies of one island name one segment in their
/// flights; they advance and roll back together, because a message to one of them is a message to
/// all.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <queue>
#include <utility>
#include <vector>

#include "framework/engines/events/flight_world.h"
#include "framework/engines/timewarp/active_pairs.h"
#include "framework/engines/timewarp/flight_boxes.h"

namespace tumble::engines {

/// The bounding box of a changing set of boxes: six heaps, of minima and maxima along each axis. A
/// removed box is deleted when it reaches the top, or when a heap holds more removed boxes than
/// current ones: for a body at rest none reaches the top.
/// Source: B. Mirtich, "Timewarp rigid body simulation", SIGGRAPH 2000.   Cost: O(log boxes) per
/// operation, on average
class SweptBox {
 public:
  void add(std::uint64_t id, const Box& box);
  void remove(std::uint64_t id) { alive_.erase(id); }
  /// An empty box, which overlaps nothing, where there is no box.
  Box box() const;
  /// Bounds in the largest heap, of current and removed boxes: after an add at most 16 plus twice
  /// the number of current boxes.
  std::size_t kept() const;

 private:
  void rebuild();

  static constexpr std::size_t kAxes = 3;
  using Bound = std::pair<double, std::uint64_t>;
  using Heap = std::priority_queue<Bound>;

  std::map<std::uint64_t, Box> alive_;
  mutable std::array<Heap, 2 * kAxes> bounds_;  // of -low, then of high
};

/// The time of a body and its flight then: enough to continue from.
struct KeptState {
  std::uint64_t id;  // unique among all states of a body in a run
  double time;       // [s]
  Flight flight;
  EventStamp began;  // the event that began the flight; without bodies for the run's start
};

/// The time up to which a flight's motion is known, at most t. A segment of an island ends where a
/// contact opens, and stands where its next step fails; a process that advanced past that time
/// stays there until the next check. [s]
double until_end(const FlightWorld& world, const Flight& flight, double t);

class TaughtLogicalProcess {
 public:
  TaughtLogicalProcess(const FlightWorld& world, int body);

  int body() const { return body_; }
  const std::vector<KeptState>& states() const { return states_; }
  double local_time() const { return states_.back().time; }
  const Flight& flight() const { return states_.back().flight; }
  const EventStamp& began() const { return states_.back().began; }
  Box swept() const { return swept_.box(); }
  /// The state at t: the last one that is not later. nullptr: it has been discarded
  const KeptState* at(double t) const;
  /// The flight before t: of the last state that is earlier, or of the first that is kept.
  const Flight& before(double t) const;
  /// The times of the states, ascending.
  std::vector<double> times() const;

  /// One integration step along the flight that it is on.
  void integrate_to(double t);
  /// Continues on another flight from now on. @pre flight.begin == local_time(), or all states are
  /// earlier
  void begin(const Flight& flight, const EventStamp& began);
  /// Drops the latest state, or the `count` oldest.
  void drop_latest();
  void drop_oldest(std::size_t count);
  /// At the end of the run: its flights are part of it up to `until`. [s]
  void stand(double until) const;

 private:
  void push(double time, const Flight& flight, const EventStamp& began, const Box& box);
  Box box_of(const Flight& flight, double from, double to) const;

  const FlightWorld& world_;
  int body_;
  std::vector<KeptState> states_;  // never empty after construction, except during a rollback
  SweptBox swept_;
  std::uint64_t next_id_ = 0;
};

}  // namespace tumble::engines
