/// The common part of `run` and `poke`: the run of a scene, its files, and its summary.
#pragma once

#include <string>

#include "framework/cli/find_scene.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/run_words.h"
#include "framework/cli/verb.h"

namespace tumble::cli {

/// Declares the words on a verb. `words` must outlive the parse.
void add_run_words(Verb& verb, RunWords& words);

/// Runs the scene, writes the requested files, prints the summary and sets context.exit.
/// @param extra  a line for the summary, under the title (may be empty)
void run_and_tell(Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                  const RunWords& words, const std::string& extra = "");

}  // namespace tumble::cli
