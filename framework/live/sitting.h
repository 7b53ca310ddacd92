/// What a sitting at the page begins with.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/live/recipe.h"

namespace tumble::live {

/// A source that is watched: saved, the scene begins again.
struct Watched {
  std::filesystem::path file;
  std::string id;  // of its assignment
};

/// A scene as it begins, with what runs it.
struct SceneStart {
  std::string name, title;
  Recipe recipe;
  // The process that simulates: it reads a line, {"recipe", "from_s", "speed", "paused"}, and
  // then the commands of simulate.h; it writes records.
  std::vector<std::string> simulator;
  // The process that finds the line of the user's file: it reads what a process said that ended
  // badly, and prints "FILE:LINE: its text", or nothing; empty: none
  std::vector<std::string> locate;
  // the command that runs a saved scene again
  std::function<std::string(const std::filesystem::path& file, const Changes& changes,
                            const std::string& modules)>
      again;
};

/// A scene that can be chosen in the page.
struct OfferedScene {
  std::string name, title;
  std::string home;                    // id of the assignment that it stands in; empty: none
  std::vector<std::string> needs;      // ids
  std::vector<std::string> unwritten;  // of these, the ones that are not written yet
};

struct Sitting : SceneStart {
  int port = 0;        // 0: any
  bool opens = false;  // opens the page in the user's browser
  // The process that prints the verdicts on an assignment, JSON: {"id", "said", "tests": [{"test",
  // "title", "verdict", "story", "function", "group", "points"}]}; empty: none
  std::function<std::vector<std::string>(const std::string& id)> judge;
  std::vector<Watched> watched;
  std::string first_judged;                                     // id; empty: none
  std::filesystem::path saves;                                  // folder for scenes
  std::function<std::string(const std::string& path)> handout;  // a page by its name; empty: none
  // What can be chosen, and one of these by its name, on the same code; empty: none.
  std::function<std::vector<OfferedScene>()> offered;
  std::function<SceneStart(const std::string& name)> scene_named;
};

/// What is left of a sitting.
struct Left {
  std::vector<std::filesystem::path> scenes;  // saved in the page, in their order
  bool has_unsaved = false;                   // something was done by hand that is in none of them
};

}  // namespace tumble::live
