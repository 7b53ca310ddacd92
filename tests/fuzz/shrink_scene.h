/// Makes a scene that fails as small as it gets while it still fails in the same way.
#pragma once

#include <functional>

#include "tests/fuzz/draw_scene.h"

namespace tumble::fuzz {

/// @param still_fails  whether a smaller scene fails as the first did; may be asked for scenes that are refused
/// @param most_trials  after so many the smallest scene found so far is good enough
Json shrink_scene(Json scene, const std::function<bool(const Json&)>& still_fails, int most_trials = 200);

}  // namespace tumble::fuzz
