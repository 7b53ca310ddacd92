/// Runs a scene by the laws given: the one entry to the engines.
#pragma once

#include <optional>
#include <string>

#include "framework/dynamics/laws.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

struct RunOptions {
  std::string engine = "rd";               // retroactive detection with fixed step
  std::optional<double> step_s;            // overrides the scene's
  std::optional<double> duration_s;        // overrides the scene's
  double frame_rate_hz = 60.0;             // of recorded frames
  std::string command;                     // for the record
};

/// Runs a scene and pushes frames and events into the sink. A run that meets NaN or runaway energy ends early with
/// `stopped_by` set; what was recorded before stays.
/// @throws UserError when the scene needs a law that nobody fills (says which assignment provides it)
void run_scene(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink);

}  // namespace tumble::engines
