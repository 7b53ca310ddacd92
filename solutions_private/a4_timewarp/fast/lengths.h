/// How far processes go at once, how large the cells of the grid are, how much time a bin of the queue holds: what speed depends on, and
/// no result does.
#pragma once

#include "framework/engines/events/flight_world.h"

namespace tumble::a4 {

struct Lengths {
  double way, cell;   // [m]
};

/// Measured on gases of 10^2 to 10^5 balls; either may be off by half and costs a tenth.
Lengths lengths_for(const engines::FlightWorld& world);

/// A bin of the queue should hold some hundred events; a process has one each time it goes on. [s]
/// @param way       of lengths_for
/// @param duration  of the run [s]
double bin_for(const engines::FlightWorld& world, double way, double duration);

}  // namespace tumble::a4
