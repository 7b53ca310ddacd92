/// How deep convex solids overlap, by brute force in doubles: separating axes over all faces and
/// pairs of edges. tests/collision/exhaustive.h does the same with 33 digits, and takes a thousand
/// times as long.
#pragma once

#include "framework/dynamics/world.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::testing {

/// The deepest overlap of any two bodies that may collide: balls, half-spaces and convex models. 0
/// where none overlap. [m]
/// @param poses  by body of the world
double deepest_overlap(const World& world, const std::vector<BodyPose>& poses);

}  // namespace tumble::testing
