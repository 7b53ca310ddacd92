/// The scene, laws and options of a run, from its words. With --accuracy or --budget-s, method and
/// step are searched for first, and the choice, its expected and its actual cost are reported.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "framework/cli/module_choice.h"
#include "framework/cli/run_words.h"
#include "framework/cli/verb.h"
#include "framework/cost/choice.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

struct PlannedRun {
  scene::Scene scene;
  Laws laws;
  engines::RunOptions options;

  /// Set where an error or a time was requested.
  struct Search {
    cost::CostGoal goal;
    cost::CostReference reference;
    cost::CostChoice choice;
    double seconds = 0.0;  // its CPU time
    bool was_cut_short = false;
  };
  std::optional<Search> search;
};

/// Declares --accuracy, --budget-s, --method and --tolerance.
void add_plan_words(Verb& verb, RunWords& words);

/// @throws UserError where an engine's word is unknown, with the nearest. Empty: none is named
/// @param flag  to stand before it in the message: "--engine "
void expect_engine(const std::string& flag, const std::string& word);

/// @throws UserError where the words of add_plan_words, engine and step contradict each other
void check_plan_words(const RunWords& words);

/// @throws UserError where words contradict each other, where the scene has no reference solution,
///   or where no method fulfils the request
PlannedRun plan_run(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                    const RunWords& words);

/// The choice with expected and actual cost. @param cpu_s  of the run, with models and shapes
std::string search_in_words(const PlannedRun::Search& search, const Trajectory& run, double cpu_s);
nlohmann::ordered_json search_as_json(const PlannedRun::Search& search, const Trajectory& run,
                                      double cpu_s);

}  // namespace tumble::cli
