/// Lengths that determine the speed but no result: the distance that processes advance at once, the
/// size of grid cells, the time in a bin of the queue.
#pragma once

#include "framework/engines/events/flight_world.h"

namespace tumble::a4 {

struct Lengths {
  double advance, cell;  // [m]
};

/// Measured on gases of 10^2 to 10^5 balls; an error of 50 % in either costs 10 % of the speed.
Lengths lengths_for(const engines::FlightWorld& world);

/// The width of a bin of the queue: about a hundred events should fall into one; a process has one
/// event per advance. [s]
/// @param advance   of lengths_for
/// @param duration  of the run [s]
double bin_for(const engines::FlightWorld& world, double advance, double duration);

}  // namespace tumble::a4
