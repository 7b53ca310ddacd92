/// The reference engine: one event after the other in the total order, by the simplest algorithm.
/// It defines the committed trace of a scene.
///
/// Every pair is checked in every window, whatever its distance; after an event all pairs of its
/// bodies are checked again. There is no broad phase, no optimism, no rollback and no heap, so that
/// it shares no possible error with a fast engine.
#pragma once

#include "framework/engines/base/run_options.h"

namespace tumble::engines {

/// @pre `laws` has every law that the scene needs (run_scene checks)
/// @throws UserError where the scene has an effect that flights do not model
/// Cost: O(n^2) per window and O(n) per event
void run_ordered(const scene::Scene& scene, const Laws& laws, const RunOptions& options,
                 TrajectorySink& sink);

}  // namespace tumble::engines
