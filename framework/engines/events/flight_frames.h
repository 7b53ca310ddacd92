/// Frames of a run whose bodies are on flights; the smallest gap of all pairs, without a query of
/// every pair where there are many.
#pragma once

#include <functional>

#include "framework/engines/events/flight_world.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// The flight of a body at the frame's time.
using FlightOf = std::function<const Flight&(int body)>;

/// @param states  by body, at that time
Frame frame_of(const FlightWorld& world, double t, const FlightOf& flight_of,
               std::vector<RigidBodyState>& states);

}  // namespace tumble::engines
