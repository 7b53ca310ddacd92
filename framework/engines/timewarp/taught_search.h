/// The search of the teaching timewarp for a collision check, before a scheduler decides on it.
#pragma once

#include <optional>

#include "framework/dynamics/scheduling.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/timewarp/taught_logical_process.h"

namespace tumble::engines {

struct FoundImpact {
  EventStamp key;
  std::uint32_t version_a, version_b;  // of the flights that meet
  // bodies of both islands at that time, ascending; without walls
  std::vector<std::int32_t> processes;
};

/// The earliest impact of a pair in [from, to], on the current flights of both, that has not been
/// executed.
std::optional<FoundImpact> find_impact(FlightRun& run, const TaughtLogicalProcess& of_a,
                                       const TaughtLogicalProcess& of_b, double from, double to);

/// The gap of two bodies at t, and bounds on its rate; `contact` is left empty.
CheckFinding closeness(const FlightWorld& world, int a, const Flight& f, int b, const Flight& g,
                       double t);

/// These bodies and the members of their islands on these flights, ascending, each once; without
/// walls.
std::vector<std::int32_t> bodies_that_move_with(const FlightWorld& world,
                                                const std::vector<BegunFlight>& flights);

/// The stamp of an event as schedulers see it.
Stamp stamp_of(const EventStamp& key);

}  // namespace tumble::engines
