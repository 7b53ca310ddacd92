/// Parts of the player's page for pages that are served while a run goes (framework/live).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::report {

/// The scene as a player's page reads it, JSON.
/// @param root   source root, where models are searched
/// @param first  the run's first frame
std::string player_scene_text(const scene::Scene& scene, const std::filesystem::path& root,
                              const Frame& first);

/// One source of the page, such as "stage.js"; empty where there is no such file.
std::string_view player_source(std::string_view name);

/// three.js, its controls and its exporter of glTF, from Debian's package. @throws UserError where
/// it is missing
std::string three_js(const std::filesystem::path& folder = "/usr/share/javascript/three");

}  // namespace tumble::report
