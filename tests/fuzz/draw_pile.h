/// Random piles from one number: boxes, balls and hulls that start near each other and fall on a
/// floor, with friction and restitution drawn by lot.
#pragma once

#include <cstdint>

#include "framework/scene/scene.h"

namespace tumble::fuzz {

/// 5 to 15 bodies of 5 to 20 cm, 0.2 to 2 kg, in columns above a floor, for 0.75 s at 240 steps a
/// second. The same number gives the same scene on every machine.
scene::Scene draw_pile(std::uint64_t number);

}  // namespace tumble::fuzz
