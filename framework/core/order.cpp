#include "framework/core/order.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/error.h"

namespace tumble {
namespace {

// times the floor: the order is then off by at most log2(1.1 / 0.9), a third
constexpr double kClear = 10.0;
constexpr std::size_t kMostPairs = 3;

double least_of(const std::vector<double>& error) {
  double least = std::numeric_limits<double>::infinity();
  for (const double e : error) least = e < least ? e : least;  // NaN is never smaller
  return least;
}

}  // namespace

std::optional<FittedOrder> fit_order(const std::vector<double>& h, const std::vector<double>& error,
                                     double floor, double largest) {
  require(h.size() == error.size(), "core: fit_order needs one error for each step");
  // Where refining no longer improves on the least error, that error is round-off: it becomes the
  // floor.
  for (std::size_t i = 0; i + 1 < error.size(); ++i)
    if (std::isfinite(error[i + 1]) && error[i + 1] >= error[i] && error[i] == least_of(error))
      floor = std::max(floor, error[i]);
  const auto shows = [&](std::size_t i) {
    return std::isfinite(error[i]) && error[i] > 0.0 && error[i] > kClear * floor &&
           error[i] < largest;
  };
  std::vector<double> slopes;  // from the fine end
  for (std::size_t i = h.size(); i-- > 1 && slopes.size() < kMostPairs;)
    if (shows(i) && shows(i - 1) && h[i - 1] > h[i])
      slopes.push_back(std::log(error[i - 1] / error[i]) / std::log(h[i - 1] / h[i]));
  if (slopes.empty()) return std::nullopt;
  std::sort(slopes.begin(), slopes.end());
  const std::size_t n = slopes.size();
  const double median = n % 2 == 1 ? slopes[n / 2] : 0.5 * (slopes[n / 2 - 1] + slopes[n / 2]);
  // One of three slopes may be affected by round-off: the two closest ones show whether the order
  // has settled.
  const double spread = n == 3 ? std::min(slopes[1] - slopes[0], slopes[2] - slopes[1])
                               : slopes.back() - slopes.front();
  return FittedOrder{median, spread, static_cast<int>(n)};
}

}  // namespace tumble
