/// A process of the teaching timewarp: the states of one body from global to local virtual time, and the box that it swept meanwhile.
/// Bodies that move together (linked, pushed, in lasting contact) name one passage in their flights; they come and go back together because
/// whoever is told of one of them is told of all.
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

/// The least box around boxes that come and go: six heaps, of minima and maxima along each axis. What has gone is thrown away when it
/// comes to the top, or when a heap holds more of it than of what is there: of a body at rest nothing comes to the top.
/// Source: B. Mirtich, "Timewarp rigid body simulation", SIGGRAPH 2000.   Cost: O(log boxes) each, on average
class SweptBox {
 public:
  void add(std::uint64_t id, const Box& box);
  void remove(std::uint64_t id) { alive_.erase(id); }
  /// Overlaps nothing where there is no box.
  Box box() const;
  /// Bounds that the largest heap holds, of boxes that are there or have gone: after an add at most twice as many as are there, and 16.
  std::size_t kept() const;

 private:
  void rebuild();

  static constexpr std::size_t kAxes = 3;
  using Bound = std::pair<double, std::uint64_t>;
  using Heap = std::priority_queue<Bound>;

  std::map<std::uint64_t, Box> alive_;
  mutable std::array<Heap, 2 * kAxes> bounds_;   // of -low, then of high
};

/// Where a body was at one time, and on which flight: what it takes to go on from there.
struct KeptState {
  std::uint64_t id;      // no two states of a body that ever were have the same
  double time;           // [s]
  Flight flight;
  EventKey began;        // the event that began the flight; of the run's start it has no bodies
};

/// The time up to which a flight's motion is known, at most t: what contacts hold together ends where they open, and whoever went on beyond
/// that as if nothing had happened is taken to stand there until somebody looks. [s]
double until_end(const FlightWorld& world, const Flight& flight, double t);

class TaughtProcess {
 public:
  TaughtProcess(const FlightWorld& world, int body);

  int body() const { return body_; }
  const std::vector<KeptState>& states() const { return states_; }
  double local_time() const { return states_.back().time; }
  const Flight& flight() const { return states_.back().flight; }
  const EventKey& began() const { return states_.back().began; }
  Box swept() const { return swept_.box(); }
  /// The state that holds at t: the last one not later. nullptr: it is forgotten
  const KeptState* at(double t) const;
  /// The times of the states, ascending.
  std::vector<double> times() const;

  /// One integration step along the flight that it is on.
  void integrate_to(double t);
  /// Goes on another flight from now on. @pre flight.begin == local_time(), or the states reach no farther
  void begin(const Flight& flight, const EventKey& began);
  /// Forgets the latest state, or the `count` oldest.
  void drop_latest();
  void drop_oldest(std::size_t count);

 private:
  void push(double time, const Flight& flight, const EventKey& began, const Box& box);
  Box box_of(const Flight& flight, double from, double to) const;

  const FlightWorld& world_;
  int body_;
  std::vector<KeptState> states_;   // never empty after construction, but while a rollback goes on
  SweptBox swept_;
  std::uint64_t next_id_ = 0;
};

}  // namespace tumble::engines
