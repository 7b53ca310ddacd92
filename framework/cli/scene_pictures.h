/// The pictures of a run.
#pragma once

#include "framework/cli/run_words.h"
#include "framework/cli/verb.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::cli {

/// Writes words.png, words.sheet and words.video where they are named, and reports it on stderr.
void write_pictures(const Context& context, const scene::Scene& scene, const Trajectory& run,
                    const RunWords& words, const PictureSize& size);

/// Writes words.virtual_times where it is named.
/// @throws UserError where the run has not so many moves as words.moves names, which is known after
///   it only: call this after all else is written
void write_chart(const scene::Scene& scene, const Trajectory& run, const RunWords& words);

}  // namespace tumble::cli
