/// From a scene to a world of bodies and effects.
#pragma once

#include "framework/dynamics/world.h"

namespace tumble {

/// Builds what the scene's entries ask for, and nothing else.
/// @throws UserError naming the body or the force that cannot be built
World build_world(const scene::Scene& scene);

}  // namespace tumble
