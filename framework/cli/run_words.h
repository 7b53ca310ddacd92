/// The words of the command line for running and showing a scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/math.h"

namespace tumble::cli {

struct RunWords {
  std::string scene;  // a path, or a bare name
  std::string modules;
  std::string engine, propagator;        // engine empty: the scene's, or rd
  std::string coordinates;               // of rods and joints; empty: the scene's
  std::optional<int> n;                  // of a scene whose size is a parameter
  std::optional<double> scale, density;  // of a scene made of a .3ds file: metres per unit, kg/m^3
  bool drop = false;                     // the same: onto a floor
  int threads = 1, most_states = 0;      // of timewarp
  std::optional<double> step_s, duration_s;
  // requested in place of engine, method and step; see planned_run.h
  std::optional<double> accuracy_m, budget_s;
  std::string method;               // of integration, in place of the laws' own; empty: theirs
  std::optional<double> tolerance;  // of a method that has one
  std::string png, sheet, video, trajectory, html;  // files to write; empty: none
  std::string virtual_times;                        // file of a chart; empty: none
  std::vector<std::size_t> moves;                   // moves of the scheduler that it shows
  std::optional<double> chart_until_s;              // its last time [s]
  std::string beside;  // how a second run in the page differs; see run_page.h
  double at_s = -1.0;  // of the PNG; negative: the end
  double speed = 1.0;  // of the video: 0.25 is slow motion
  std::string size = "640x480";
  bool json = false;
};

struct PictureSize {
  int width, height;
};

/// @throws UserError unless "WxH" with both in [16, 4096]
PictureSize parse_size(const std::string& text);

/// The words with output files behind the links that were named, so that links stay. Refuses before
/// the run what would be refused after it: output files that cannot be written or end as other
/// files do, two with one name, pictures, videos and pages that this machine cannot make, a picture
/// of an instant that the run does not reach.
/// @throws UserError
RunWords with_outputs(RunWords words, double duration_s);

/// Three comma-separated numbers after a flag, such as "1,0,-2".
Vector3d parse_vector(const std::string& flag, const std::string& text);

}  // namespace tumble::cli
