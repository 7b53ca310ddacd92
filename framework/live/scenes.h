/// The scenes of a sitting: the one that is shown, those that can be chosen, and what was done to
/// each by hand that is not saved.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/live/history.h"
#include "framework/live/pages.h"
#include "framework/live/sitting.h"

namespace tumble::live {

struct SavedScene {
  std::filesystem::path file;
  std::string again;  // the command that runs it again
  Recipe recipe;      // that does the same
};

/// `wanted` is what has been done to the scene that is shown: the recipe of its run.
class Scenes {
 public:
  Scenes(const Sitting& sitting, Pages& pages)
      : sitting_(sitting), pages_(pages), shown_(sitting), saved_recipe_(as_text(sitting.recipe)) {}

  const SceneStart& shown() const { return shown_; }
  bool can_be_chosen() const { return static_cast<bool>(sitting_.offered); }
  Json words() const;
  Json offered_words() const;
  /// Another scene takes the place of the one that is shown. What was done to that one is kept for
  /// when it is chosen again.
  /// @return what the chosen scene begins with  @throws UserError for a name that there is not
  Recipe choose(const std::string& name, const Recipe& wanted);
  /// What a run of the scene has asked of the modules (simulate.h) is kept. @return it, for pages
  Json asked(const std::string& modules);
  /// Writes a scene file. @throws UserError where the scene is made by code, or has not moved
  SavedScene save(const Recipe& recipe, const History& run);

  /// A scene that is made by code cannot be saved: what is done to it is never kept.
  Left left(const Recipe& wanted) const;
  /// {"is": whether what was done to the shown scene is in no file, "others": names of the other
  /// scenes of which that holds}, as pages were told last
  const Json& unsaved() const { return unsaved_; }
  void look_for_unsaved(const Recipe& wanted) { tell_unsaved(unsaved_of(wanted)); }
  /// A hand has acted on the shown scene.
  void touched();

 private:
  Json unsaved_of(const Recipe& wanted) const;
  void tell_unsaved(const Json& unsaved);

  const Sitting& sitting_;
  Pages& pages_;
  SceneStart shown_;
  std::string saved_recipe_;  // of the shown scene, as it was saved last or at the start
  struct Kept {
    Recipe recipe;
    std::string saved_recipe;
  };
  std::map<std::string, Kept> left_;   // by name: scenes that were left for another one
  std::map<std::string, Json> asked_;  // by name: ids and functions, as far as runs have shown
  std::vector<std::filesystem::path> files_;  // saved
  Json unsaved_{{"is", false}, {"others", Json::array()}};
};

}  // namespace tumble::live
