/// Boxes around what bodies sweep: what a broad phase over local virtual times looks at.
#pragma once

#include "framework/engines/events/flight_world.h"
#include "framework/engines/timewarp/active_pairs.h"

namespace tumble::engines {

/// Around a movable body on its flight over [from, to]. World frame. [m]
/// @pre  the flight, or the passage that it names, goes on until `to` [s]
Box swept_box(const FlightWorld& world, int body, const Flight& flight, double from, double to);

/// Around an immovable body over [0, duration]: its prescribed motion is a straight line, and it is never farther off the line than the amplitude. World frame. [m]
Box box_of_immovable(const FlightWorld& world, int body, double duration);

}  // namespace tumble::engines
