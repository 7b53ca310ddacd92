/// What the teaching timewarp finds out for a collision check, before a scheduler decides on it.
#pragma once

#include <optional>

#include "framework/dynamics/scheduling.h"
#include "framework/engines/events/flight_run.h"
#include "framework/engines/timewarp/taught_process.h"

namespace tumble::engines {

struct FoundImpact {
  EventKey key;
  std::uint32_t serial_a, serial_b;   // of the flights that meet
  std::vector<std::int32_t> processes;   // bodies that move with either then, ascending; walls are none
};

/// The earliest impact of a pair in [from, to], on the flights that both have now, that nobody has worked at.
std::optional<FoundImpact> find_impact(FlightRun& run, const TaughtProcess& of_a, const TaughtProcess& of_b, double from, double to);

/// How far two bodies are apart at t, and bounds on how fast that changes; `contact` is left empty.
CheckFinding closeness(const FlightWorld& world, int a, const Flight& f, int b, const Flight& g, double t);

/// These bodies and those that move with them on these flights, ascending, each once; walls are none.
std::vector<std::int32_t> bodies_that_move_with(const FlightWorld& world, const std::vector<BegunFlight>& flights);

/// An event as schedulers know it.
Stamp stamp_of(const EventKey& key);

}  // namespace tumble::engines
