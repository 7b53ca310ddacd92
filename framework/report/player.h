/// A self-contained page that plays a recorded run, or two side by side: the motion in three
/// dimensions, curves, events.
///
///   report::write_player("fall.html", scene, {{run, "student"}, {reference, "reference"}});
///
/// The page needs no network and no server: it contains three.js (Debian's libjs-three) and the
/// data, deflated. Without WebGL it says so and shows curves and events; without scripts it shows
/// plots and a table.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/report/played_run.h"
#include "framework/scene/scene.h"

namespace tumble::report {

/// Refuses before a run what its page would be refused for after it.
/// @throws UserError when three.js is missing
void expect_player(const PlayerOptions& options = {});

/// The page.
/// @param runs  one or two, each of the scene and with at least one frame
/// @throws UserError when three.js is missing, or a run has no frame
std::string player_page(const scene::Scene& scene, const std::vector<PlayedRun>& runs,
                        const PlayerOptions& options = {});

/// Writes the page whole or not at all.
/// @return its size in bytes
std::size_t write_player(const std::filesystem::path& file, const scene::Scene& scene,
                         const std::vector<PlayedRun>& runs, const PlayerOptions& options = {});

/// Writes three.js, deflated, and the player's scripts, for pages with `options.three_file`. The
/// same bytes for all pages of one program: write it anew with them.
/// @throws UserError when three.js is missing
void write_three(const std::filesystem::path& file, const PlayerOptions& options = {});

}  // namespace tumble::report
