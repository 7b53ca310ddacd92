/// What a player's page shows.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/trajectory/trajectory.h"

namespace tumble::report {

struct PlayedRun {
  const Trajectory& run;
  std::string label;             // "student", "reference"; may be empty where there is one run only
};

/// A chart of an engine's own, shown beside the curves (local virtual times, for example). The page's script draws it by a function that
/// registered itself under the kind: `panelKinds.virtual_times = (element, data, player) => ({ at(time_s) {} })` in player/panel_*.js.
struct PlayerPanel {
  std::string kind, title;
  std::string data_json;         // what that function is given
};

struct PlayerOptions {
  std::filesystem::path root;                                              // source root, where models are looked for; empty: see scene::build_solid
  std::filesystem::path three = "/usr/share/javascript/three";             // where Debian's package puts three.js
  std::vector<PlayerPanel> panels;
  std::size_t most_poses = 4'000'000;      // of a run (bodies that move times frames): beyond it every second, third, ... frame is kept, and the page says so
  std::size_t most_contacts = 1'000'000;   // of a run: beyond it contact points of every second, third, ... frame are kept
};

}  // namespace tumble::report
