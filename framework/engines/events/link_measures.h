/// Forces of springs, rods, joints and persistent contacts in a frame of an event-driven run.
#pragma once

#include <vector>

#include "framework/engines/events/flight_frames.h"
#include "framework/engines/stepping/linked_bodies.h"

namespace tumble::engines {

class LinkMeasures {
 public:
  LinkMeasures(const FlightWorld& world, const Laws& laws);
  LinkMeasures(const LinkMeasures&) = delete;
  LinkMeasures& operator=(const LinkMeasures&) = delete;

  /// Fills in the forces of a frame.
  void measure(Frame& frame, const FlightOf& flight_of);

 private:
  Wrench wrench_on(int body, const RigidBodyState& state) const;

  const FlightWorld& world_;
  RunCounters uncounted_;  // measuring does not count as work of the run
  std::vector<LinkedBodies> groups_;
  // by index in effects::all(): steady forces on the island that is measured
  std::map<int, std::unique_ptr<effects::SteadyForces>> forces_;
};

/// Times at which forces switch, up to `until`: events in order.
std::vector<Event> force_switches(const World& world, double until);

}  // namespace tumble::engines
