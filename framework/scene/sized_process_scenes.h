/// Scenes with a size in which some bodies do not fly freely: vehicles, pendula, arms, rocks,
/// dominoes, a cradle. Part of sized_scenes.
#pragma once

#include "framework/scene/scene.h"

namespace tumble::scene {

/// Vehicles with a chassis and four driven wheels (one per hundred pendula, at least one) that
/// drive through n pendula.
Scene cars(int n);
/// n arms of eight links each, with two blocks per arm, which bounce on the floor and are hit.
Scene robots(int n);
/// n rocks that slide down a slope and pile up below.
Scene avalanche(int n);
/// n dominoes in a row, the first of them pushed.
Scene dominoes(int n);
/// n balls on two rods each, a micrometre apart, the first one released.
Scene cradle(int n);

}  // namespace tumble::scene
