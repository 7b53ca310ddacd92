/// Where the anchors of springs, rods and joints are, and how they move.
#pragma once

#include <utility>
#include <vector>

#include "framework/dynamics/constraint.h"
#include "framework/dynamics/world.h"

namespace tumble {

/// Place of an anchor. World frame. [m]
/// @param states  by body index; of an immovable body too, whose place is taken from there
Vector3d anchor_point(const Anchor& anchor, const std::vector<RigidBodyState>& states);

/// Place and velocity of an anchor. World frame. [m], [m/s]
/// @param states  by body index; an immovable body is where its own motion has it at `time` [s],
/// whatever its state says
AnchorState anchor_state(const Anchor& anchor, const World& world,
                         const std::vector<RigidBodyState>& states, double time);

/// How the distance of two anchors changes with the velocities of their bodies: of A's and of B's,
/// (linear, angular), world. Where the anchors are at one place any direction will do: it is z.
/// What belongs to the world is 0.
std::pair<Vector6d, Vector6d> distance_jacobians(const Anchor& a, const Anchor& b,
                                                 const std::vector<RigidBodyState>& states);

}  // namespace tumble
