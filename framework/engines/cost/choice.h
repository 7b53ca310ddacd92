/// Chooses method and step for an error that is asked for, or for a time that may be spent.
///
/// Nothing is extrapolated: a choice is a run that was made, with the very steps, tolerance and frames of the one to come. A run is
/// deterministic, so its error is known before it is made again; only its price is an expectation.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/engines/cost/cost.h"

namespace tumble::engines {

/// One of the two.
struct CostWish {
  std::optional<double> error_m;    // at most, at every sample of the truth
  std::optional<double> price_s;    // at most, CPU time of the engine
};

/// A way with all that makes it one run.
struct CostChoice {
  CostWay way;
  long steps = 1;                   // a sample of the truth
  double tolerance = kUnset;        // of a controlled method
  CostRung rung;                    // the trial that it stands on
};

/// What came of the search.
struct CostChoices {
  std::optional<CostChoice> best;   // what the wish asks for; empty: nothing fulfils it
  std::optional<CostChoice> closest;   // least error (of a wish for accuracy) or least price of all that were tried
  bool was_cut_short = false;       // by most_s: something better may exist
};

/// @param truth   its samples are the frames of the run to come
/// @param most_s  CPU time of the search
/// @param told    called after each trial, for progress
CostChoices choose_way(const scene::Scene& scene, const std::vector<CostWay>& ways, const CostTruth& truth, const CostWish& wish, double most_s, const CostOptions& options,
                       const std::function<void(const CostChoice&)>& told);

}  // namespace tumble::engines
