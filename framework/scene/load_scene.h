/// Reads a scene file (JSON; scene.schema.json says every key, its unit and its meaning) and checks it whole.
#pragma once

#include <filesystem>
#include <string>

#include "framework/scene/scene.h"

namespace tumble::scene {

/// @param file  path of a .json file
/// @return the scene, complete and consistent: names resolve, numbers are finite, quaternions are unit, `repeat` and `chains` are written out
/// @throws UserError whose `where` is FILE:LINE: /json/pointer, and whose text says what was found, what was expected, what to do
Scene load_scene(const std::filesystem::path& file);

/// The same from text, for tests and for scenes that never stood in a file.
/// @param file  what errors and `Scene::file` call it
Scene parse_scene(const std::string& text, const std::filesystem::path& file);

}  // namespace tumble::scene
