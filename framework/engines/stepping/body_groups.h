/// Which bodies belong together: those that touch each other or are linked, directly or through
/// others.
#pragma once

#include <utility>
#include <vector>

#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

/// By body: the least index among the bodies it belongs together with; its own where it stands
/// alone. An immovable body joins none.
/// @param touching  pairs of bodies
std::vector<int> group_leaders(const MovingWorld& moving,
                               const std::vector<std::pair<int, int>>& touching);

}  // namespace tumble::engines
