/// Whether a scene holds or pushes a body at a point far outside it, as it does where a place in
/// the world was written down as one in the body's frame, or the other way round.
#pragma once

#include <optional>
#include <string>

#include "framework/scene/scene.h"

namespace tumble::engines {

/// Ends of rods and springs, joints that are far from both of their bodies, and points at which
/// forces that begin with the run push. Allowed: the body then has an arm without mass. Bodies
/// without size and immovable ones are not looked at.
/// @return nothing where none is farther than one and a half of its body's radius
std::optional<std::string> notice_of_far_points(const scene::Scene& scene);

}  // namespace tumble::engines
