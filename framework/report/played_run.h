/// Input of a player's page.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/trajectory/trajectory.h"

namespace tumble::report {

struct PlayedRun {
  const Trajectory& run;
  std::string label;  // "student", "reference"; may be empty for a single run
};

/// An engine's own chart beside the curves, such as local virtual times. It is drawn by the
/// function that player/panel_*.js registers for the kind: `panelKinds.virtual_times = (element,
/// data, player) => ({ at(time_s) {} })`.
struct PlayerPanel {
  std::string kind, title;
  std::string data_json;  // argument `data` of that function
};

struct PlayerOptions {
  // source root, where models are searched; empty: see scene::build_solid
  std::filesystem::path root;
  // folder of three.js in Debian's package
  std::filesystem::path three = "/usr/share/javascript/three";
  // three.js and scripts in a file beside the page (write_three), for reports with many pages;
  // empty: inside the page
  std::filesystem::path three_file;
  std::vector<PlayerPanel> panels;
  // limit per run (moving bodies times frames): above it only every second, third, ... frame is
  // kept, and the page says so
  std::size_t most_poses = 4'000'000;
  // limit per run: above it contact points of only every second, third, ... frame are kept
  std::size_t most_contacts = 1'000'000;
};

}  // namespace tumble::report
