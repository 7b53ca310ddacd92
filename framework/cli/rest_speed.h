/// Whether the speed at which bounces end in rest is much for a scene's bodies.
#pragma once

#include <string>

#include "framework/scene/scene.h"

namespace tumble::cli {

/// Bounces that separate more slowly than the rest speed end in rest: a fixed speed, which for a
/// small or a slow body is much. Says so of the first body whose last bounce reaches a part of its
/// size, or in free space of its speed, that could be seen, with a rest speed that suits it.
/// @return empty where there is none
std::string note_of_rest_speed(const scene::Scene& scene);

}  // namespace tumble::cli
