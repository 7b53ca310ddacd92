/// Timewarp on the decisions of a module: a student's scheduler drives a scene, and is judged by
/// what it commits.
///
/// Provided here: the queue, the states, integration steps, the search of an interval, the pairs
/// whose swept boxes overlap, impulses, frames. Decided by `laws.scheduling`
/// (framework/dynamics/scheduling.h): all else. The ordered reference runs first; the run stops,
/// with a message, at the first committed event or frame that differs.
///
/// It is written to be understood and to show the consequence of a wrong decision, not for speed:
/// every body is tested against every other. Islands of linked bodies or persistent contacts, and
/// callbacks, are supported (taught_groups.h): members of a group keep their own states and receive
/// every message together.
#pragma once

#include "framework/engines/base/run_options.h"

namespace tumble::engines {

/// @pre `laws.scheduling` is filled
/// @throws UserError where the scene has an effect that flights do not model
/// Cost: O(n) per integration step
void run_taught_timewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                         TrajectorySink& sink);

}  // namespace tumble::engines
