/// Lots for a scene that is made by code.
#pragma once

#include <cstdint>

#include "framework/core/random.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

/// The seed is noted in the scene, so that every record of a run names it.
inline Random lots(std::uint64_t seed, Scene& scene) {
  scene.seeds.push_back(seed);
  return Random(seed);
}

}  // namespace tumble::scene
