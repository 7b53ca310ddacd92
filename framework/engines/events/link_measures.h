/// What springs, rods, joints and lasting contacts pull and push with in a frame of an event-ordered run.
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
  RunCounters uncounted_;                  // measuring is no part of the run
  std::vector<LinkedBodies> groups_;
  std::map<int, std::unique_ptr<effects::SteadyForces>> forces_;   // by place in effects::all(), as they act on the group that is measured
};

/// When forces are switched, up to a time: events in order.
std::vector<Event> force_switches(const World& world, double until);

}  // namespace tumble::engines
