/// The effects that the program is built with: the folders under framework/effects, which
/// CMakeLists.txt there finds.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/effects/effect.h"

namespace tumble::effects {

/// Always in the same order, in which forces are added and effects are listed: those with a line in
/// CMakeLists.txt, then all others by name.
const std::vector<const Effect*>& all();

inline constexpr std::size_t kMost = 32;  // counts stand in arrays of this size

/// Everything that the scene asks effects to draw.
Drawables drawn(const scene::Scene& scene);

/// Whose the listed laws are that the scene's effects ask: "the drag of a plate by a6 student",
/// each once. Left out are laws of modules that provide impulses, motion or constraints, too: they
/// are named for these.
std::vector<std::string> authors_of_listed_laws(const scene::Scene& scene, const Laws& laws);

/// Whether an effect that the scene asks for asks a law of this assignment, such as "a3".
bool asks_laws_of(const std::string& assignment, const scene::Scene& scene);

}  // namespace tumble::effects
