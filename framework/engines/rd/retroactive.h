/// Retroactive detection with a fixed step: step all bodies, find the earliest discontinuity, roll
/// all back to it, go on.
///
/// Overlaps that are left at a commit are removed; frames record the smallest gap.
///
/// Source: B. Mirtich, Timewarp Rigid Body Simulation, SIGGRAPH 2000, sec. 2.
#pragma once

#include "framework/engines/base/run_options.h"

namespace tumble::engines {

/// @pre `laws` has every law that the scene needs (run_scene checks)
void run_retroactive(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                     TrajectorySink& sink);

}  // namespace tumble::engines
