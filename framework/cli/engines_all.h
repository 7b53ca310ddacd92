/// `tumble engines` without a scene: the scenes of the course and the paper by every engine, on one
/// page.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/cli/verb.h"

namespace tumble::cli {

constexpr const char* kAllScenes = "all";

/// The words of the command line.
struct EnginesWords {
  std::string scene, modules, engines = "rd,ca,tw", out = "out/engines", propagator;
  std::vector<int> sizes;
  std::optional<int> n;
  std::optional<double> duration_s, step_s;
  int threads = 1;    // of tw, in one scene
  bool full = false;  // sizes of the paper
  bool no_videos = false;
  bool small = false;  // a few scenes, smaller still
  bool json = false;   // on stdout, for machines
  bool quiet = false;  // nothing on stdout: used within a larger report
  // of that report: its three.js, seen from a scene's folder; empty: the page has its own
  std::filesystem::path three_file = {};
};

/// Runs them and writes words.out/index.html, with a folder beside it for each scene.
/// Sets context.exit where a run fails its scene's checks.
/// @throws UserError for words that belong to one scene
void engines_of_all(Context& context, const EnginesWords& words);

}  // namespace tumble::cli
