/// Reduces a failing scene as long as it fails in the same way.
#pragma once

#include <functional>

#include "tests/fuzz/draw_scene.h"

namespace tumble::fuzz {

/// @param still_fails  whether a smaller scene has the same failure; may be called with scenes that
///   are refused
/// @param most_trials  number of trials after which the smallest scene so far is returned
Json shrink_scene(Json scene, const std::function<bool(const Json&)>& still_fails,
                  int most_trials = 200);

}  // namespace tumble::fuzz
