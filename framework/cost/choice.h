/// Chooses method and resolution for a requested error, or for a given CPU time.
///
/// Nothing is extrapolated: a choice is a run that was made, with the steps, tolerance and frames
/// of the run to come. A run is deterministic, so its error is known; only its CPU time is an
/// estimate.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/cost/cost.h"

namespace tumble::cost {

/// One of the two.
struct CostGoal {
  std::optional<double> error_m;  // at most, at every sample of the reference
  std::optional<double> price_s;  // at most, CPU time of the engine
};

/// A method with its resolution: one run.
struct CostChoice {
  CostMethod method;
  long steps = 1;             // per sample of the reference
  double tolerance = kUnset;  // of a controlled method
  CostResult result;          // the measured run
};

/// Result of the search.
struct CostChoices {
  std::optional<CostChoice> best;  // fulfils the goal; empty: none does
  // least error (for a goal of accuracy) or least cost of all measured runs
  std::optional<CostChoice> closest;
  bool was_cut_short = false;  // by most_s: a better one may exist
};

/// @param reference  its samples are the frames of the run to come
/// @param most_s     CPU time of the search
/// @param progress   called after each measured run
CostChoices choose_method(const scene::Scene& scene, const std::vector<CostMethod>& methods,
                          const CostReference& reference, const CostGoal& goal, double most_s,
                          const CostOptions& options,
                          const std::function<void(const CostChoice&)>& progress);

}  // namespace tumble::cost
