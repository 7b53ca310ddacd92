/// A case of a time of impact as input for a root finder: a gap over time, and a step in which it
/// closes.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "framework/core/root.h"
#include "framework/truths/truth_case.h"

namespace tumble::truths {

struct ImpactProblem {
  std::string name;                     // of the case
  ScalarFunction gap, gap_rate;         // [m], [m/s]
  double low, high;                     // [s]: the step that contains the impact
  double toi;                           // of the file [s]
  std::function<double()> closed_form;  // the same [s]; empty where there is none
};

/// @param window_s  length of a step; the first begins at 0
/// @return nothing for families without a simple root in a step (grazing impacts, bullets that pass
///   the wall within it, and cases without an impact)
std::optional<ImpactProblem> impact_problem(const Case& truth, double window_s);

}  // namespace tumble::truths
