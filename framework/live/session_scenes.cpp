// The scenes of a sitting: the one that is shown, those that can be chosen, and what was done to
// each that is not saved.
#include "framework/live/session_parts.h"

#include <algorithm>

#include "framework/core/error.h"

namespace tumble::live {

Json Session::scene_words() const {
  return {{"kind", "scene"},
          {"name", scene_.name},
          {"title", scene_.title},
          {"can_save", !scene_.recipe.document.empty()}};
}

Json Session::scenes_words() const {
  Json words{{"kind", "scenes"}, {"own", sitting_.first_judged}, {"scenes", Json::array()}};
  if (!sitting_.offered) return words;
  for (const OfferedScene& scene : sitting_.offered()) {
    Json one{{"name", scene.name},
             {"title", scene.title},
             {"home", scene.home},
             {"needs", scene.needs},
             {"unwritten", scene.unwritten}};
    if (const auto asked = asked_of_scenes_.find(scene.name); asked != asked_of_scenes_.end()) {
      one["asked"] = Json::object();
      for (const auto& [id, functions] : asked->second.items())
        for (const auto& [function, unused] : functions.items())
          one["asked"][id].push_back(function);
    }
    words["scenes"].push_back(std::move(one));
  }
  return words;
}

// Another scene takes the place of the one that is shown, on the same code. What was done to that
// one by hand is kept for when it is chosen again.
void Session::choose_scene(const std::string& name) {
  if (name == scene_.name) return;
  if (!sitting_.scene_named) throw UserError(name, "this page has one scene", "");
  SceneStart chosen = sitting_.scene_named(name);  // throws for a name that there is not
  left_scenes_[scene_.name] = {wanted(), saved_recipe_};
  running_.reset();
  starting_.reset();
  locator_.reset();
  scene_ = std::move(chosen);
  recipe_ = scene_.recipe;
  saved_recipe_ = as_text(recipe_);
  if (const auto kept = left_scenes_.find(scene_.name); kept != left_scenes_.end()) {
    recipe_ = kept->second.recipe;
    saved_recipe_ = kept->second.saved_recipe;
    left_scenes_.erase(kept);
  }
  current_ = former_ = History();
  former_has_ended_ = has_difference_ = false;
  compared_until_ = 0.0;
  times_.clear();
  for (std::string* told : {&trouble_, &difference_, &end_, &asked_}) told->clear();
  is_paused_ = false;
  tell(scene_words());
  if (sitting_.offered) tell(scenes_words());
  begin("scene", 0.0, Recipe(recipe_));
}

// A scene that is made by code cannot be saved: what is done to it is never kept.
Left Session::left() const {
  const auto is_unsaved = [](const Recipe& recipe, const std::string& saved) {
    return !recipe.document.empty() && as_text(recipe) != saved;
  };
  return {scenes_, is_unsaved(wanted(), saved_recipe_) ||
                       std::any_of(left_scenes_.begin(), left_scenes_.end(), [&](const auto& one) {
                         return is_unsaved(one.second.recipe, one.second.saved_recipe);
                       })};
}

void Session::look_for_unsaved() { tell_unsaved(left().has_unsaved); }

void Session::tell_unsaved(bool is_unsaved) {
  if (is_unsaved == is_unsaved_) return;
  is_unsaved_ = is_unsaved;
  tell({{"kind", "unsaved"}, {"is", is_unsaved_}});
}

}  // namespace tumble::live
