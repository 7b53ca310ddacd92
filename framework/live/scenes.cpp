#include "framework/live/scenes.h"

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace tumble::live {

Json Scenes::words() const {
  return {{"kind", "scene"},
          {"name", shown_.name},
          {"title", shown_.title},
          {"can_save", !shown_.recipe.document.empty()}};
}

Json Scenes::offered_words() const {
  Json words{{"kind", "scenes"}, {"own", sitting_.first_judged}, {"scenes", Json::array()}};
  if (!sitting_.offered) return words;
  for (const OfferedScene& scene : sitting_.offered()) {
    Json one{{"name", scene.name},
             {"title", scene.title},
             {"home", scene.home},
             {"needs", scene.needs},
             {"unwritten", scene.unwritten}};
    if (const auto asked = asked_.find(scene.name); asked != asked_.end()) {
      one["asked"] = Json::object();
      for (const auto& [id, functions] : asked->second.items())
        for (const auto& [function, unused] : functions.items())
          one["asked"][id].push_back(function);
    }
    words["scenes"].push_back(std::move(one));
  }
  return words;
}

Recipe Scenes::choose(const std::string& name, const Recipe& wanted) {
  if (!sitting_.scene_named) throw UserError(name, "this page has one scene", "");
  SceneStart chosen = sitting_.scene_named(name);
  left_[shown_.name] = {wanted, saved_recipe_};
  shown_ = std::move(chosen);
  Kept begun{shown_.recipe, as_text(shown_.recipe)};
  if (const auto kept = left_.extract(shown_.name)) begun = kept.mapped();
  saved_recipe_ = begun.saved_recipe;
  return begun.recipe;
}

Json Scenes::asked(const std::string& modules) {
  const Json all = Json::parse(modules);
  Json& kept = asked_[shown_.name];
  for (const Json& module : all)
    for (const Json& function : module.at("functions"))
      if (function.at(1) > 0)
        kept[module.at("id").get<std::string>()][function.at(0).get<std::string>()] = true;
  return {{"kind", "asked"}, {"scene", shown_.name}, {"modules", all}};
}

SavedScene Scenes::save(const Recipe& recipe, const History& run) {
  if (shown_.recipe.document.empty())
    throw UserError(shown_.name, "is made by code and has no scene file to add pushes to",
                    "Begin with a scene file.");
  if (run.frames().empty()) throw UserError(shown_.name, "has not moved yet", "");
  SavedScene saved;
  for (int number = 1; saved.file.empty() || std::filesystem::exists(saved.file); ++number)
    saved.file = sitting_.saves / fmt::format("{}_{}.json", shown_.name, number);
  const Json head = Json::parse(run.head());
  if (shown_.again)
    saved.again = shown_.again(saved.file, recipe.changes, head.value("modules", ""));
  write_whole(saved.file, saved_document(recipe, run.end_s(), saved.again));
  files_.push_back(saved.file);
  saved_recipe_ = as_text(recipe);
  saved.recipe.document = text_of(saved.file);
  saved.recipe.file = shown_.recipe.file;
  saved.recipe.changes.method = recipe.changes.method;
  return saved;
}

Json Scenes::unsaved_of(const Recipe& wanted) const {
  const auto is_unsaved = [](const Recipe& recipe, const std::string& saved) {
    return !recipe.document.empty() && as_text(recipe) != saved;
  };
  Json unsaved{{"is", is_unsaved(wanted, saved_recipe_)}, {"others", Json::array()}};
  for (const auto& [name, kept] : left_)
    if (is_unsaved(kept.recipe, kept.saved_recipe)) unsaved["others"].push_back(name);
  return unsaved;
}

Left Scenes::left(const Recipe& wanted) const {
  const Json unsaved = unsaved_of(wanted);
  return {files_, unsaved.at("is") || !unsaved.at("others").empty()};
}

void Scenes::touched() {
  if (shown_.recipe.document.empty()) return;
  Json unsaved = unsaved_;
  unsaved["is"] = true;
  tell_unsaved(unsaved);
}

void Scenes::tell_unsaved(const Json& unsaved) {
  if (unsaved == unsaved_) return;
  unsaved_ = unsaved;
  Json words{{"kind", "unsaved"}};
  words.update(unsaved);
  pages_.tell(words);
}

}  // namespace tumble::live
