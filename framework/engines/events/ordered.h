/// The reference: one event after the other in their total order, with nothing clever. It defines the committed trace of a scene.
///
/// Every pair is looked at in every window, whatever lies between the two; after an event everything about its bodies is looked at
/// again. There is no broad phase, no optimism, no rollback, no heap: nothing that could be wrong in the same way as a fast engine.
#pragma once

#include "framework/engines/base/run_options.h"

namespace tumble::engines {

/// @pre `laws` has every law that the scene needs (run_scene checks)
/// @throws UserError where the scene has what no flight follows
/// Cost: O(n^2) a window and O(n) an event
void run_ordered(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink);

}  // namespace tumble::engines
