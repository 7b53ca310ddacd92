/// Collision response of two bodies on their flights: the laws' impulse, rest, or a separation
/// impulse below the restitution threshold.
///
/// Several bodies that touch at one instant collide pair by pair in the order of events (flight.h):
/// lowest microstep first, then lowest bodies. For equal balls in a row and restitution 1 this is
/// Newton's cradle.
///
/// It knows two bodies only, and so differs from the impacts of a world (sequential_impacts.h)
/// below the restitution threshold: balls rest on supports that stand still, not on those that move
/// evenly; a meeting is a micro-impact only where the body's last impact was with the same partner;
/// each point of a flat contact is pushed apart, not only the one that approaches fastest; and a
/// meeting without an impulse is an event of impulse 0.
#pragma once

#include <memory>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/engines/base/run_watch.h"
#include "framework/engines/events/flight_world.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// A discontinuity: the event, and the flights of its pair or its processes that begin with it.
struct Discontinuity {
  EventStamp key;
  // of key.body_a and key.body_b, from key.time on; the caller sets their versions
  Flight a, b;
  // with processes: all flights that begin; `a` and `b` are then unused
  std::vector<BegunFlight> begun;
  double impulse = 0.0;     // sum of the impulses along the normal [N s]
  Event first;              // the first impulse, or the transition to rest without one
  std::vector<Event> more;  // further impulses of flat contacts; transitions to rest
  // members of a process separate without contact: no event is recorded
  bool is_silent = false;
  // of an impact of processes, or of the end of a segment: what a run that commits it must not keep
  // silent; null: nothing
  std::unique_ptr<RunWatch> noted{};
};

struct FlightImpactRules {
  double restitution_threshold;  // [m/s]
  // a pair slower than the restitution threshold that meets again within this time gets that
  // separation speed [s]
  double micro_interval;
};

class FlightImpactResponse {
 public:
  /// @pre `laws` has the three laws of an impact
  FlightImpactResponse(const FlightWorld& world, const Laws& laws, FlightImpactRules rules)
      : world_(world), laws_(laws), rules_(rules) {}

  /// @param f, g  flights of key.body_a and key.body_b, which meet at key.time
  /// @throws StoppedRun where the laws leave the two approaching, or return values that are not
  ///   finite
  Discontinuity resolve_impact(const EventStamp& key, const Flight& f, const Flight& g) const;

 private:
  struct Work;
  void collide(Work& work) const;
  void push(Work& work, const Contact& contact, double impulse) const;
  void hop(Work& work) const;
  bool settle(Work& work, int body, int support) const;
  void remove_overlaps(Work& work) const;
  Flight flight_of(const Work& work, int body, const Flight& before, const Body& now) const;

  const FlightWorld& world_;
  const Laws& laws_;
  FlightImpactRules rules_;
};

}  // namespace tumble::engines
