/// The methods that `tumble cost` compares: the words of its command line as curves to be measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/cli/module_choice.h"
#include "framework/cli/verb.h"
#include "framework/cost/cost.h"

namespace tumble::cli {

/// How names of methods in joint coordinates end.
inline constexpr const char* kInJointCoordinates = ", joint coordinates";

struct CostWords {
  std::string scene;  // or an assignment's id
  std::string modules, on, out = "out/cost";
  // empty: those that suit the scene
  std::vector<std::string> methods, engines, stabilisations, impacts, solvers, steps, coordinates;
  std::vector<double> tolerances;
  bool json = false;  // the same on stdout for machines
  std::optional<double> duration_s;
  std::optional<int> n;
  // CPU time of all refinements together [s]; empty: usual_budget_s
  std::optional<double> budget_s;

  // with the reference a scene takes less than a minute
  static constexpr double kUsualBudget = 30.0;
  double budget() const { return budget_s.value_or(kUsualBudget); }

  /// @throws UserError for a word that is neither a number nor 1/N
  std::vector<double> steps_s() const;
  /// Name of the page's folder.
  std::string name() const;
};

/// Subject of a measurement.
struct CostSubject {
  scene::Scene scene;
  std::string title;
  std::optional<double> duration_s;  // suitable duration; empty: the scene's
  Laws truth_laws;
  std::string note;  // remark on reading the costs; may be empty
  std::vector<cost::CostMethod> methods;
  std::vector<std::string> not_run;                // methods left out, with the reason
  std::vector<std::shared_ptr<void>> connections;  // to sandboxes
};

/// A method of integration of the library in place of the laws' own.
cost::CostMethod method_by_integrator(const Method& integrator, const Laws& laws);
/// @param word            auto (rd with closed forms), ca, tw, ordered
/// @param in_closed_form  for the whole scene: else there are processes, which are integrated by
///   RK4 with a refinement of their steps
cost::CostMethod method_by_engine(const std::string& word, const Laws& laws, bool in_closed_form);

/// Checks the words that name something in every scene.
/// @throws UserError with the word that is unknown
void check_known(const CostWords& words);

/// @throws UserError with the word that is unknown or does not suit the scene
CostSubject find_subject(const Context& context, const CostWords& words);

}  // namespace tumble::cli
