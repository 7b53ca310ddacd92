/// Which ways to run a scene `tumble cost` compares: the words of its command line as curves to be measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/cli/module_choice.h"
#include "framework/cli/verb.h"
#include "framework/engines/cost/cost.h"

namespace tumble::cli {

struct CostWords {
  std::string scene;                     // or an assignment's id
  std::string modules, on, out = "out/cost";
  std::vector<std::string> methods, engines, stabilisations, impacts, solvers, steps;   // empty: what suits the scene
  std::vector<double> tolerances;
  std::optional<double> duration_s;
  std::optional<int> n;
  std::optional<double> budget_s;        // CPU time of all ladders together [s]; empty: usual_budget_s

  static constexpr double kUsualBudget = 30.0;    // with the search for the truth a scene takes less than a minute
  double budget() const { return budget_s.value_or(kUsualBudget); }

  /// @throws UserError for what is neither a number nor 1/N
  std::vector<double> steps_s() const;
  /// Of the page's folder.
  std::string name() const;
};

/// What is measured.
struct CostSubject {
  scene::Scene scene;
  std::string title;
  std::optional<double> duration_s;      // that suits it; empty: the scene's
  Laws truth_laws;
  std::string note;                      // what to know when reading the prices; may be empty
  std::vector<engines::CostWay> ways;
  std::vector<std::string> not_run;      // ways that would be looked at, were it not for a reason
  std::vector<std::shared_ptr<void>> connections;   // to sandboxes
};

/// A method of the library in place of the laws' own.
engines::CostWay way_by_method(const Method& method, const Laws& laws);
/// @param word            auto (rd with closed forms), ca, tw, ordered
/// @param in_closed_form  the whole scene: else there are processes, which go by RK4, and a ladder of their steps
engines::CostWay way_by_engine(const std::string& word, const Laws& laws, bool in_closed_form);

/// @throws UserError naming what is not known, or does not suit the scene
CostSubject find_subject(const Context& context, const CostWords& words);

}  // namespace tumble::cli
