/// The time of impact of two bodies on their flights: the search of an interval on which
/// event-driven engines are built.
///
/// The answer about two flights depends on the two flights alone, to the last bit: not on the time
/// of the query, nor on earlier queries. So every engine finds the same impacts, in whatever order
/// it works. Balls, and balls against fixed half-spaces, have closed forms; other pairs are
/// searched by collision/first_impact in windows of time whose limits are fixed.
#pragma once

#include "framework/collision/first_impact.h"
#include "framework/engines/events/flight_world.h"

namespace tumble::engines {

/// Cost counters of searches.
struct CheckCost {
  std::uint64_t pair_checks = 0;
  collision::ImpactCost narrow;
};

class FlightImpactDetection {
 public:
  /// @param window  length of the windows in which pairs without a closed form are searched [s], >
  ///   0
  FlightImpactDetection(const FlightWorld& world, collision::RootFinder root_finder, double window)
      : world_(world), root_finder_(std::move(root_finder)), window_(window) {}

  double window() const { return window_; }
  /// The end of the window that contains t, later than t. [s]
  double window_end(double t) const { return window_begin(window_of(t) + 1); }
  /// Whether the pair has a closed form: an unlimited lookahead at the cost of one evaluation.
  bool has_closed_form(int a, const Flight& f, int b, const Flight& g) const;

  /// The first impact of A on flight f and B on flight g, not before the later of the two began, if
  /// it lies in a window that begins before `to` (closed forms: at any time).
  /// @param from  windows that end at or before this are skipped [s]
  /// @return [s]; infinite where there is none. The same time for all `from` and `to` that include
  ///   it
  /// @pre can_move(a) or can_move(b); the two do not overlap where the later flight begins (by more
  ///   than rounding)
  double first_impact(int a, const Flight& f, int b, const Flight& g, double from, double to,
                      CheckCost& cost) const;

  /// Whether the bounding balls of the two come within reach of each other in [low, high]. Fast; a
  /// "no" is always right.
  bool may_meet(int a, const Flight& f, int b, const Flight& g, double low, double high) const;

 private:
  double window_begin(std::int64_t k) const { return static_cast<double>(k) * window_; }
  std::int64_t window_of(double t) const;
  bool falls(int body, const Flight& flight) const {
    return world_.can_move(body) && !flight.is_resting;
  }
  bool may_meet_on_segment(int a, const Flight& f, int b, const Flight& g, double low,
                           double high) const;
  double of_balls(int a, const Flight& f, int b, const Flight& g) const;
  double of_ball_and_plane(int ball, const Flight& f, const Flight& plane) const;
  double in_windows(int a, const Flight& f, int b, const Flight& g, double from, double to,
                    CheckCost& cost) const;
  void require_searchable(int body, const Flight& flight, double duration) const;

  const FlightWorld& world_;
  collision::RootFinder root_finder_;
  double window_;
};

/// The stamp of the impact of two flights at a time.
EventStamp key_of_impact(int a, const Flight& f, int b, const Flight& g, double time);

}  // namespace tumble::engines
