/// The effects that the program is built with. Each registers itself by its line in
/// framework/effects/CMakeLists.txt.
#pragma once

#include <cstddef>
#include <vector>

#include "framework/effects/effect.h"

namespace tumble::effects {

/// Always in the same order: that of the lines, in which forces are added and effects are listed.
const std::vector<const Effect*>& all();

inline constexpr std::size_t kMost = 32;  // counts stand in arrays of this size

/// Everything that the scene asks effects to draw.
Drawables drawn(const scene::Scene& scene);

/// Whether an effect that the scene asks for asks a law of this assignment, such as "a3".
bool asks_laws_of(const std::string& assignment, const scene::Scene& scene);

}  // namespace tumble::effects
