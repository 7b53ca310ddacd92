/// What the words of a run come to: the scene, laws and options that an engine is given. Where an error or a time is asked for
/// (--accuracy, --budget-s), method and step are looked for first, and what was chosen, expected and paid is told.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "framework/cli/module_choice.h"
#include "framework/cli/run_words.h"
#include "framework/cli/verb.h"
#include "framework/engines/cost/choice.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

struct PlannedRun {
  scene::Scene scene;
  Laws laws;
  engines::RunOptions options;

  /// Where something was asked for.
  struct Search {
    engines::CostWish wish;
    engines::CostTruth truth;
    engines::CostChoice choice;
    double seconds = 0.0;            // CPU that it took
    bool was_cut_short = false;
  };
  std::optional<Search> search;
};

/// Declares --accuracy, --budget-s, --method and --tolerance.
void add_plan_words(Verb& verb, RunWords& words);

/// @throws UserError where words contradict each other, where the scene has no truth, or where nothing reaches what is asked for
PlannedRun plan_run(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen, const RunWords& words);

/// What was chosen and expected, and what was paid. @param cpu_s  of the run, with models and shapes
std::string search_in_words(const PlannedRun::Search& search, const Trajectory& run, double cpu_s);
nlohmann::ordered_json search_as_json(const PlannedRun::Search& search, const Trajectory& run, double cpu_s);

}  // namespace tumble::cli
