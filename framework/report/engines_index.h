/// The page out/engines/index.html: the course's scenes by every engine, the slides' tables with our numbers, and the model of cost.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/report/engines_page.h"

namespace tumble::report {

/// One scene by every engine. Paths are relative to the page; an empty one is not linked.
struct EnginesScene {
  std::string name, title, about, command;
  std::string problem;                     // why there is nothing; empty: there is
  std::vector<EngineRow> rows;
  std::vector<std::string> checks;         // what the scene's own numbers say of each run
  bool is_right = true;                    // all of them
  Figure figure;
  std::filesystem::path page, player;
};

struct EnginesIndex {
  std::vector<EnginesScene> scenes;
  std::vector<std::vector<EngineRow>> ladder;   // of atoms: sizes ascending
  std::vector<std::vector<EngineRow>> ghosts, pong;   // of balls on a table that ignore each other, and that collide: sizes ascending; may be empty
  bool is_full = false;                         // sizes as in the paper
  std::string record;
};

/// A line a scene: size, w h, time of each engine against timewarp, agreement.
Table table_of_scenes(const std::vector<EnginesScene>& scenes);
/// A line a scene, w ascending: how far each engine takes a body at once, on the average.
Table table_of_mean_steps(const std::vector<EnginesScene>& scenes);
/// The slides' total times beside those of the ladder, where sizes are the same.
Table table_of_slides(const std::vector<std::vector<EngineRow>>& ladder);
/// One row a size and engine of the ladder: average integration step, work a body, total time.
Table table_of_ladder(const std::vector<std::vector<EngineRow>>& ladder);

/// @throws UserError when the file cannot be written
void write_engines_index(const EnginesIndex& index, const std::filesystem::path& file);

}  // namespace tumble::report
