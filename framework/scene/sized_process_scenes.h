/// Scenes with a size whose bodies do not all fly freely: vehicles, pendula, arms, rocks, dominoes, a cradle. Part of sized_scenes.
#pragma once

#include "framework/scene/scene.h"

namespace tumble::scene {

/// Vehicles of a chassis and four driven wheels (one for every hundred pendula, at least one) on their way through n pendula.
Scene cars(int n);
/// n arms of eight links each, and two blocks an arm, which bounce on the floor and are hit.
Scene robots(int n);
/// n rocks that come down a slope, and heap up below.
Scene avalanche(int n);
/// n dominoes in a row, the first of them pushed.
Scene dominoes(int n);
/// n balls on two rods each, a micrometre apart, the first one let go.
Scene cradle(int n);

}  // namespace tumble::scene
