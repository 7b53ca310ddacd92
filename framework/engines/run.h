/// Runs a scene by the laws given: the one entry to the engines.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/engines/base/run_options.h"

namespace tumble::engines {

/// What --engine knows, with what each is: rd, ca, tw, ordered.
const std::vector<std::pair<std::string, std::string>>& engine_words();

/// Runs a scene and pushes frames and events into the sink. A run that meets NaN or runaway energy
/// ends early with `stopped_by` set; what was recorded before stays.
/// @throws UserError when the scene needs a law that nobody fills (says which assignment provides
///         it)
void run_scene(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
               TrajectorySink& sink);

}  // namespace tumble::engines
