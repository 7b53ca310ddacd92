/// One scene by one engine for `tumble engines`: run, CPU time, agreement with the other engines.
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

/// Options of a run.
struct EngineChoice {
  std::string engine;  // a word of engines::engine_words()
  std::string label;   // of its column; empty: the engine's word
  std::optional<double> step_s, duration_s;
  std::string propagator;  // of rd
  int threads = 1;         // of tw
  // wall time instead of CPU time: used where one of the engines has several threads
  bool by_the_clock = false;
  // of the run that is kept; pictures are not part of the measured time
  double frame_rate_hz = 10.0;
  bool is_timed = true;  // false: only shown, as far as it gets in most_s
  // of CPU: a longer run is left out, and its row says so
  double most_s = std::numeric_limits<double>::infinity();
};

struct EngineRun {
  report::EngineRow row;
  Trajectory run;  // without frames where the engine did not run
};

/// The engines named by words with commas between them.
/// @throws UserError naming the words there are
std::vector<EngineChoice> engines_named(const std::string& words);

/// Runs the scene, first for its time, then for its frames. The row says where an engine does not
/// support an entry of the scene, or would take too long.
EngineRun measure_engine(const Context& context, const scene::Scene& scene,
                         const ChosenLaws& chosen, const EngineChoice& choice);

/// Adds to each row its agreement with an event-driven run: traces bit for bit, else positions
/// until chaos.
void tell_agreement(std::vector<EngineRun>& runs);

std::vector<report::EngineRow> rows_of(const std::vector<EngineRun>& runs);
void print_rows(const std::vector<report::EngineRow>& rows);

}  // namespace tumble::cli
