/// The result of a refinement in one sentence.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/order.h"
#include "framework/cost/cost.h"

namespace tumble::cost {

/// The observed order: against the step, or against 1 / evaluations where the method chooses its
/// own steps.
std::optional<FittedOrder> order_of(const CostMethod& method,
                                    const std::vector<CostResult>& results,
                                    const CostReference& reference);

/// Whether a refinement has at least the order of its method, or errors too small to show one.
bool keeps_promise(const CostMethod& method, const std::vector<CostResult>& results,
                   const CostReference& reference);

/// A sentence on a refinement: whether it converges, with which order, and the likely error where
/// it does not.
/// @param smooth  without impacts, contacts, rods and joints, so that the method alone determines
///   the order
std::string read_refinement(const CostMethod& method, const std::vector<CostResult>& results,
                            const CostReference& reference, bool smooth);

}  // namespace tumble::cost
