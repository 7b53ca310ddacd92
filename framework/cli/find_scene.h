/// Scenes and models by what a person calls them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/cli/run_words.h"
#include "framework/cli/verb.h"
#include "framework/scene/model_scene.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

/// @param word   path of a scene file, or the bare name of one under assignments/*/scenes,
///               or the name of a scene whose size is a parameter,
///               or a .3ds file (a path, or one of models/): the scene is made of it (scene/model_scene.h)
/// @param n      that size; nothing: its default
/// @param model  how a scene is made of a .3ds file
/// @throws UserError naming the scenes there are, that a scene has one size only, or what is wrong with a model
scene::Scene find_scene(const Context& context, const std::string& word, std::optional<int> n = std::nullopt, const scene::ModelSceneOptions& model = {});

/// The scene that the words of a run name. @param turns  of a .3ds file: whether it turns by itself
/// @throws UserError also where words about a model stand beside a scene that is none
scene::Scene scene_of_words(const Context& context, const RunWords& words, bool turns);

/// The names of every scene there is: those of the assignments, then those with a size.
std::vector<std::string> scene_names(const Context& context);

}  // namespace tumble::cli
