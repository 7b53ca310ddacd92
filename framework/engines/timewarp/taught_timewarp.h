/// Timewarp on the decisions of a module: a student's scheduler drives a scene, and is judged by what it commits.
///
/// Given here: the queue, the states, the steps of integration, the search of an interval, the pairs whose swept boxes overlap, the
/// impulses, the frames. Decided by `laws.scheduling` (framework/dynamics/scheduling.h): all the rest. The ordered reference is run
/// first, and the run stops, in words, at the first thing committed that is not the reference's.
///
/// It is made to be understood and to give a wrong decision its consequence, not to be fast: every body is asked about every other.
/// Bodies that links or lasting contacts hold together, and callbacks, are followed too (taught_groups.h): members of a group keep their
/// own states and are told of everything together.
#pragma once

#include "framework/engines/base/run_options.h"

namespace tumble::engines {

/// @pre `laws.scheduling` is filled
/// @throws UserError where the scene has what no flight follows
/// Cost: O(n) an integration step
void run_taught_timewarp(const scene::Scene& scene, const Laws& laws, const RunOptions& options, TrajectorySink& sink);

}  // namespace tumble::engines
