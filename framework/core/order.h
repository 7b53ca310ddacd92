/// The order of convergence that a refinement sequence shows.
#pragma once

#include <optional>
#include <vector>

namespace tumble {

/// Slopes that show an order: one alone may be any.
inline constexpr int kPairsOfAnOrder = 2;

struct FittedOrder {
  double order;  // p of  error ~ C h^p
  // between the two closest slopes behind the order: small where the order has settled
  double spread;
  int pairs;  // number of slopes, at most 3
};

/// Slope of log(error) over log(h) at the fine end of a refinement sequence: the median over the
/// last three pairs of neighbours whose errors are both finite, below `largest` (coarser ones do
/// not follow the power law yet) and well above the error floor. Where errors grow again on
/// refinement, the least error is taken as the floor: that is round-off.
/// @param h        of each resolution, > 0, falling: step sizes, or 1 / evaluations
/// @param error    of each resolution, >= 0
/// @param floor    error of the reference solution, or round-off: errors below ten times the floor
///   are not used
/// @param largest  errors above it are not used
/// @return nothing where no two neighbouring errors can be used
/// Source: E. Hairer, S. P. Norsett, G. Wanner, "Solving ODEs I", II.4 (numerical determination of
/// the order).
std::optional<FittedOrder> fit_order(const std::vector<double>& h, const std::vector<double>& error,
                                     double floor, double largest);

}  // namespace tumble
