/// Swept boxes of bodies: the input of a broad phase over local virtual times.
#pragma once

#include "framework/engines/events/flight_world.h"
#include "framework/engines/timewarp/active_pairs.h"

namespace tumble::engines {

/// Swept box of a movable body on its flight over [from, to]. World frame. [m]
/// @pre  the flight, or the segment that it names, lasts until `to` [s]
Box swept_box(const FlightWorld& world, int body, const Flight& flight, double from, double to);

/// Swept box of an immovable body over [0, duration]: its prescribed motion is a straight line,
/// with an oscillation of at most the amplitude around it. World frame. [m]
Box box_of_immovable(const FlightWorld& world, int body, double duration);

}  // namespace tumble::engines
