/// Turns what a scene says about links into what a world holds: names into indices, points into frames.
#pragma once

#include "framework/dynamics/world.h"

namespace tumble {

/// Fills rods, joints, motors, contact, stabilisation and apart. @pre world.bodies are built
/// @throws UserError naming the link and the body that is not there
void build_links(const scene::Scene& scene, World& world);

}  // namespace tumble
