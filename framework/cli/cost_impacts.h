/// tumble cost toi: the cost of a time of impact by each root finder over its tolerance, with the
/// reference values of times of impact.
#pragma once

#include "framework/cli/cost_methods.h"
#include "framework/report/cost_page.h"

namespace tumble::cli {

/// The word that stands for this in place of a scene or an assignment.
inline constexpr const char* kImpactWord = "toi";

/// Gaps of balls, rods and boxes over steps of 1/60 s in which they close (tests/truths/toi_*). The
/// modules' own root finder is included where --modules names one.
/// @throws UserError without a file of reference values, or for an unknown word after --impacts
report::CostPage cost_of_impacts(const Context& context, const CostWords& words);

}  // namespace tumble::cli
