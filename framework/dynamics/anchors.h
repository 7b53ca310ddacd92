/// Where the anchors of springs, rods and joints are, and how they move.
#pragma once

#include <vector>

#include "framework/dynamics/constraint.h"
#include "framework/dynamics/world.h"

namespace tumble {

/// Place of an anchor. World frame. [m]
/// @param states  by body index; of an immovable body too, whose place is taken from there
Vector3d anchor_point(const Anchor& anchor, const std::vector<RigidBodyState>& states);

/// Place and velocity of an anchor. World frame. [m], [m/s]
/// @param states  by body index; an immovable body is where its own motion has it at `time` [s], whatever its state says
AnchorState anchor_state(const Anchor& anchor, const World& world, const std::vector<RigidBodyState>& states, double time);

}  // namespace tumble
