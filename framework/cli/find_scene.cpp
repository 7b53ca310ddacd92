#include "framework/cli/find_scene.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "framework/cli/find_model.h"
#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/scene/load_scene.h"
#include "framework/scene/sized_scenes.h"
#include "framework/scene/words.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> scenes_of(const Context& context) {
  std::set<fs::path> files;
  std::error_code ignored;
  for (const auto* kind : context.registry.all())
    for (const auto& entry :
         fs::directory_iterator(context.root / "assignments" / kind->folder / "scenes", ignored))
      if (entry.path().extension() == ".json") files.insert(entry.path());
  return {files.begin(), files.end()};
}

/// Name and title of every scene, a line each, for an error.
std::string listing(const Context& context) {
  std::string lines;
  for (const ListedScene& scene : listed_scenes(context))
    lines += fmt::format("\n  {:<24} {}", scene.name, scene.title);
  return lines;
}

std::string sized_names() {
  std::string names;
  for (const scene::SizedScene& sized : scene::sized_scenes())
    names += (names.empty() ? "" : ", ") + sized.name;
  return names;
}

}  // namespace

scene::Scene scene_of_words(const Context& context, const RunWords& words, bool turns) {
  if ((words.scale || words.density || words.drop) && !scene::names_model(words.scene))
    throw UserError(words.scale     ? "--scale"
                    : words.density ? "--density"
                                    : "--drop",
                    "'" + words.scene + "' is a scene, which says its sizes and masses itself",
                    "These words are about a .3ds file: tumble run t_handle.3ds --drop");
  scene::ModelSceneOptions model;
  if (words.scale) model.metres_per_unit = *words.scale;
  if (words.density) model.density_kg_m3 = *words.density;
  model.is_dropped = words.drop;
  model.turns = turns;
  scene::Scene scene = find_scene(context, words.scene, words.n, model);
  if (!words.coordinates.empty()) {
    scene.coordinates = scene::coordinates_named(words.coordinates, "--coordinates");
    if (!scene::is_constrained(scene))
      throw UserError("--coordinates " + words.coordinates,
                      scene.name + " has no rods and no joints",
                      "Leave the flag out, or take a scene such as double_pendulum.");
  }
  return scene;
}

scene::Scene find_scene(const Context& context, const std::string& word, std::optional<int> n,
                        const scene::ModelSceneOptions& model) {
  if (const scene::SizedScene* sized = scene::sized_scene_named(word);
      sized != nullptr && !fs::is_regular_file(word)) {
    scene::Scene made = scene::make_sized_scene(word, n.value_or(sized->default_n));
    made.file = context.root / "models" / word;  // models are found beside it
    return made;
  }
  if (n)
    throw UserError("--n " + std::to_string(*n), "'" + word + "' has one size",
                    "Sizes are parameters of " + sized_names() + ".");
  if (scene::names_model(word))
    return scene::make_model_scene(find_model_file(context, word), model);
  if (fs::is_regular_file(word)) return scene::load_scene(word);
  if (word.ends_with(".json") || word.find('/') != std::string::npos) {
    std::error_code failed;
    if (fs::exists(word, failed))
      throw UserError(word, fs::is_directory(word, failed) ? "is a folder" : "is no plain file",
                      "Give the path of a scene file, or a scene's bare name: tumble scenes lists "
                      "them.");
    throw UserError(word, "there is no such file",
                    "Check the path, or give a scene's bare name: " + listing(context));
  }
  std::vector<fs::path> beginning;  // an unambiguous prefix of a name is accepted
  std::vector<std::string> names_there;
  for (const auto& file : scenes_of(context)) {
    if (file.stem() == word) return scene::load_scene(file);
    if (file.stem().string().starts_with(word)) beginning.push_back(file);
    names_there.push_back(file.stem());
  }
  if (beginning.size() == 1) return scene::load_scene(beginning.front());
  if (beginning.empty())
    throw UserError(word, "there is no such scene." + did_you_mean(word, names_there),
                    "Give the path of a scene file, or one of these: " + listing(context));
  std::string names;
  for (const auto& file : beginning) names += (names.empty() ? "" : ", ") + file.stem().string();
  throw UserError(word, "more than one scene begins like this: " + names, "Give more of the name.");
}

std::vector<ListedScene> listed_scenes(const Context& context) {
  std::vector<ListedScene> all;
  for (const fs::path& file : scenes_of(context)) {
    ListedScene listed{.name = file.stem().string(),
                       .title = {},
                       .folder = file.parent_path().parent_path().filename().string(),
                       .needs = {},
                       .file = file,
                       .problem = {}};
    try {
      const scene::Scene scene = scene::load_scene(file);
      listed.title = scene.title;
      listed.needs = scene.needs;
    } catch (const UserError& error) {
      listed.problem = error.what();
      listed.title = "(cannot be read: " + listed.problem + ")";
    }
    all.push_back(std::move(listed));
  }
  for (const scene::SizedScene& sized : scene::sized_scenes())
    all.push_back(
        {.name = sized.name,
         .title = fmt::format("{} (--n {}: {})", sized.title, sized.default_n, sized.counts),
         .folder = {},
         .needs = scene::make_sized_scene(sized.name, sized.default_n).needs,
         .file = {},
         .problem = {},
         .default_n = sized.default_n});
  return all;
}

std::vector<std::string> scene_names(const Context& context) {
  std::vector<std::string> names;
  for (const fs::path& file : scenes_of(context)) names.push_back(file.stem().string());
  for (const scene::SizedScene& sized : scene::sized_scenes()) names.push_back(sized.name);
  return names;
}

}  // namespace tumble::cli
