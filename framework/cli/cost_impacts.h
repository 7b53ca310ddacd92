/// tumble cost toi: what a time of impact costs, by each root finder over its tolerance, against the truths about times of impact.
#pragma once

#include "framework/cli/cost_ways.h"
#include "framework/report/cost_page.h"

namespace tumble::cli {

/// The words that are no scene and no assignment, but this.
inline constexpr const char* kImpactWord = "toi";

/// Gaps of balls, rods and boxes over steps of 1/60 s in which they close (tests/truths/toi_*). The modules' own finder is one of them where
/// --modules names one.
/// @throws UserError where no truth file is there, or --impacts names nothing that is known
report::CostPage cost_of_impacts(const Context& context, const CostWords& words);

}  // namespace tumble::cli
