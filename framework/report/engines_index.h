/// The page out/engines/index.html: the course's scenes in every engine, the slides' tables with
/// the project's numbers, and the cost model.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/report/engines_page.h"

namespace tumble::report {

/// One scene in every engine. Paths are relative to the page; an empty one is not linked.
struct EnginesScene {
  std::string name, title, about, command;
  std::string problem;  // why there is no result; empty: there is one
  std::vector<EngineRow> rows;
  std::vector<std::string> checks;  // results of the scene's checks, by run
  bool is_right = true;             // all checks hold
  Figure figure;
  std::filesystem::path page, player;
};

struct EnginesIndex {
  std::vector<EnginesScene> scenes;
  std::vector<std::vector<EngineRow>> ladder;  // of atoms, by ascending size
  // of balls on a table that ignore each other, and that collide, by ascending size; may be empty
  std::vector<std::vector<EngineRow>> ghosts, pong;
  bool is_full = false;  // with the sizes of the paper
  std::string record;
};

/// One row per scene: size, w h, time of each engine relative to timewarp, agreement.
Table table_of_scenes(const std::vector<EnginesScene>& scenes);
/// One row per scene, by ascending w: mean integration step of each engine.
Table table_of_mean_steps(const std::vector<EnginesScene>& scenes);
/// The slides' total times beside those of the sequence of sizes, where sizes are equal.
Table table_of_slides(const std::vector<std::vector<EngineRow>>& ladder);
/// One row per size and engine: average integration step, work per body, total time.
Table table_of_ladder(const std::vector<std::vector<EngineRow>>& ladder);

/// @throws UserError when the file cannot be written
void write_engines_index(const EnginesIndex& index, const std::filesystem::path& file);

}  // namespace tumble::report
