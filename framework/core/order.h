/// The order of convergence that a ladder of errors shows.
#pragma once

#include <optional>
#include <vector>

namespace tumble {

struct FittedOrder {
  double order;      // p of  error ~ C h^p
  double spread;     // how far the two closest slopes that it stands on lie apart: small where the order has settled
  int pairs;         // how many these are, at most 3
};

/// Slope of log(error) over log(h) at the fine end of a ladder: the median of the last three pairs of neighbours whose errors are both
/// finite, below `largest` (coarser ones do not yet follow the power law) and well above the floor, or above the least error where
/// finer rungs got worse again: that is round-off.
/// @param h        of each rung, > 0, falling: steps, or 1 / evaluations
/// @param error    of each rung, >= 0
/// @param floor    what the truth itself, or round-off, is wrong by: rungs within ten times of it show nothing
/// @param largest  errors above this show nothing either
/// @return nothing where fewer than two rungs show anything
/// Source: E. Hairer, S. P. Norsett, G. Wanner, "Solving ODEs I", II.4 (numerical determination of the order).
std::optional<FittedOrder> fit_order(const std::vector<double>& h, const std::vector<double>& error, double floor, double largest);

}  // namespace tumble
