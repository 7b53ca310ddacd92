/// Scenes and models by name or path.
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
///               or a .3ds file (a path, or one of models/): a scene with that model
///               (scene/model_scene.h)
/// @param n      that size; nothing: its default
/// @param model  how a scene is made of a .3ds file
/// @throws UserError with the known scenes, with the one size of a scene, or with the defect of a
///   model
scene::Scene find_scene(const Context& context, const std::string& word,
                        std::optional<int> n = std::nullopt,
                        const scene::ModelSceneOptions& model = {});

/// The scene of a run's words. @param turns  of a .3ds file: whether it rotates from the start
/// @throws UserError also for words about a model with a scene that is none
scene::Scene scene_of_words(const Context& context, const RunWords& words, bool turns);

/// What a list of scenes says of one.
struct ListedScene {
  std::string name, title;
  std::string folder;              // of its assignment; empty for a scene with a size
  std::vector<std::string> needs;  // assignments whose laws it runs on
  std::filesystem::path file;      // empty for a scene with a size
  std::string problem;             // why the file cannot be read; empty where it can
  int default_n = 0;               // of a scene with a size
};
/// All of them, in the order of their files, then those with a size.
std::vector<ListedScene> listed_scenes(const Context& context);

/// The names of all scenes: those of the assignments, then those with a size.
std::vector<std::string> scene_names(const Context& context);

}  // namespace tumble::cli
