/// What `tumble engines` does with one scene and one engine: run it, take its time, see whether it agrees with the others.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "framework/cli/module_choice.h"
#include "framework/cli/verb.h"
#include "framework/report/engines_page.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::cli {

/// How a scene is run.
struct EngineChoice {
  std::string engine;                    // a word of engines::engine_words()
  std::string label;                     // of its column; empty: the engine's word
  std::optional<double> step_s, duration_s;
  std::string propagator;                // of rd
  int threads = 1;                       // of tw
  bool by_the_clock = false;             // time on the wall instead of CPU time: what counts where one of the engines has several threads
  double frame_rate_hz = 10.0;           // of the run that is kept; pictures are no part of the time that is taken
  bool is_timed = true;                  // false: shown only, as far as it comes in most_s
  double most_s = std::numeric_limits<double>::infinity();   // of CPU: a run that takes longer is left out, and its row says so
};

struct EngineRun {
  report::EngineRow row;
  Trajectory run;                        // no frames where it did not run
};

/// The engines named by words with commas between them.
/// @throws UserError naming the words there are
std::vector<EngineChoice> engines_named(const std::string& words);

/// Runs the scene, first for its time, then for its frames. What a scene asks for and an engine cannot follow stands in the row, and that it
/// would take too long.
EngineRun measure_engine(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen, const EngineChoice& choice);

/// Says in each row whether it agrees with a run that goes from event to event: traces bit for bit, else until chaos.
void tell_agreement(std::vector<EngineRun>& runs);

std::vector<report::EngineRow> rows_of(const std::vector<EngineRun>& runs);
void print_rows(const std::vector<report::EngineRow>& rows);

}  // namespace tumble::cli
