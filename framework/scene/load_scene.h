/// Reads a scene file (JSON; scene.schema.json defines every key with its unit and meaning) and
/// checks all of it.
#pragma once

#include <filesystem>
#include <string>

#include "framework/scene/scene.h"

namespace tumble::scene {

/// @param file  path of a .json file
/// @return the scene, complete and consistent: names resolve, numbers are finite, quaternions are
///   unit, `repeat` and `chains` are expanded
/// @throws UserError whose `where` is FILE:LINE: /json/pointer, and whose text gives what was
///   found, what was expected, and the remedy
Scene load_scene(const std::filesystem::path& file);

/// The same from text, for tests and for scenes without a file.
/// @param file  its name in errors and in `Scene::file`
Scene parse_scene(const std::string& text, const std::filesystem::path& file);

}  // namespace tumble::scene
