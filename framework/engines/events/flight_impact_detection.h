/// When two bodies on their flights meet: the check of an interval that event-ordered engines stand on.
///
/// The answer about two flights depends on the two flights alone, to the last bit: not on when it is asked, nor on what had been looked
/// at before. So every engine, in whatever order it works, finds the same impacts. Balls, and balls against still half-spaces, have
/// closed forms; other pairs are searched by collision/first_impact in windows of time that stand fast.
#pragma once

#include "framework/collision/first_impact.h"
#include "framework/engines/events/flight_world.h"

namespace tumble::engines {

/// What checks cost.
struct CheckCost {
  std::uint64_t pair_checks = 0;
  collision::ImpactCost narrow;
};

class ImpactsOfFlights {
 public:
  /// @param window  length of the windows in which pairs without a closed form are searched [s], > 0
  ImpactsOfFlights(const FlightWorld& world, collision::RootFinder root_finder, double window)
      : world_(world), root_finder_(std::move(root_finder)), window_(window) {}

  double window() const { return window_; }
  /// The end of the window that holds t, later than t. [s]
  double window_end(double t) const { return window_begin(window_of(t) + 1); }
  /// Whether the pair has a closed form, which looks ahead without end for no more than it costs to look at all.
  bool has_closed_form(int a, const Flight& f, int b, const Flight& g) const;

  /// The first impact of A on flight f and B on flight g that is not before the later of the two began, if it lies in a window (for
  /// closed forms: at any time) that begins before `to`.
  /// @param from  nothing is looked for in windows that end at or before this [s]
  /// @return [s]; infinite where there is none. The same time whatever `from` and `to`, where they let it be seen
  /// @pre can_move(a) or can_move(b); the two do not overlap where the later flight begins (by more than roundings)
  double first_impact(int a, const Flight& f, int b, const Flight& g, double from, double to, CheckCost& cost) const;

  /// Whether the balls around the two come within reach of each other in [low, high]: quick, and never a wrong no.
  bool may_meet(int a, const Flight& f, int b, const Flight& g, double low, double high) const;

 private:
  double window_begin(std::int64_t k) const { return static_cast<double>(k) * window_; }
  std::int64_t window_of(double t) const;
  bool falls(int body, const Flight& flight) const { return world_.can_move(body) && !flight.is_resting; }
  bool may_meet_on_passage(int a, const Flight& f, int b, const Flight& g, double low, double high) const;
  double of_balls(int a, const Flight& f, int b, const Flight& g) const;
  double of_ball_and_plane(int ball, const Flight& f, const Flight& plane) const;
  double in_windows(int a, const Flight& f, int b, const Flight& g, double from, double to, CheckCost& cost) const;
  void require_searchable(int body, const Flight& flight, double duration) const;

  const FlightWorld& world_;
  collision::RootFinder root_finder_;
  double window_;
};

/// The key of the impact of two flights at a time.
EventKey key_of_impact(int a, const Flight& f, int b, const Flight& g, double time);

}  // namespace tumble::engines
