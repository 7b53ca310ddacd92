/// One self-contained page that plays a recorded run: the motion in three dimensions, curves, events; one run, or two beside each other.
///
///   report::write_player("fall.html", scene, {{run, "student"}, {reference, "reference"}});
///
/// The page needs no network and no server: three.js (Debian's libjs-three) and the data stand in it, deflated. Where it finds no WebGL it
/// says so and shows curves and events; where it finds no scripts at all, plots and a table that were written here.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/scene/scene.h"
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

/// The page.
/// @param runs  one or two, each of the scene and with at least one frame
/// @throws UserError when three.js is not there, or a run has no frame
std::string player_page(const scene::Scene& scene, const std::vector<PlayedRun>& runs, const PlayerOptions& options = {});

/// Whole or not at all.   @return its size in bytes
std::size_t write_player(const std::filesystem::path& file, const scene::Scene& scene, const std::vector<PlayedRun>& runs, const PlayerOptions& options = {});

}  // namespace tumble::report
