/// What a ladder says, in a sentence.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/order.h"
#include "framework/engines/cost/cost.h"

namespace tumble::engines {

/// The order that a ladder shows: against the step, or against 1 / evaluations where the method chooses its own steps.
std::optional<FittedOrder> order_of(const CostWay& way, const std::vector<CostRung>& rungs, const CostTruth& truth);

/// Whether a ladder does what its method promises: it shows the order, or a better one, or there is nothing left to show.
bool keeps_promise(const CostWay& way, const std::vector<CostRung>& rungs, const CostTruth& truth);

/// A sentence that reads the ladder: whether it converges, as fast as it should, and what to look for where it does not.
/// @param smooth  nothing meets anything and no rods or joints are there: the method alone sets the order
std::string read_ladder(const CostWay& way, const std::vector<CostRung>& rungs, const CostTruth& truth, bool smooth);

}  // namespace tumble::engines
