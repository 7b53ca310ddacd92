// The order that a refinement sequence shows.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "framework/core/order.h"

namespace tumble::testing {
namespace {

constexpr double kNone = 1e300;  // no error is too large to count

std::vector<double> halvings(double first, int count) {
  std::vector<double> h;
  for (int k = 0; k < count; ++k) h.push_back(first * std::pow(0.5, k));
  return h;
}

TEST(FittedOrder, OfAPowerLawIsItsExponent) {
  const std::vector<double> h = halvings(0.1, 6);
  std::vector<double> error;
  for (const double step : h) error.push_back(3.0 * std::pow(step, 4));
  const auto fit = fit_order(h, error, 0.0, kNone);
  ASSERT_TRUE(fit);
  // A quotient of two logarithms, each with a few rounding errors: some eps over log 2.
  EXPECT_NEAR(fit->order, 4.0, 1e-13);
  EXPECT_NEAR(fit->spread, 0.0, 1e-13);
  EXPECT_EQ(fit->pairs, 3);
}

TEST(FittedOrder, IgnoresTheErrorFloorAndTooCoarseSteps) {
  const std::vector<double> h = halvings(1.0, 10);
  std::vector<double> error;
  // second order between a ceiling and a floor
  for (const double step : h) error.push_back(std::min(step * step + 1e-4, 0.5));
  const auto fit = fit_order(h, error, 1e-4, 0.3);
  ASSERT_TRUE(fit);
  // The floor of 1e-4 is at most a tenth of each error counted: log2(1.1) = 0.14 off. Errors at the
  // floor would give order 0.
  EXPECT_NEAR(fit->order, 2.0, 0.14);
}

TEST(FittedOrder, IsAbsentWhenTooFewErrorsCanBeUsed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fit_order({0.1, 0.05}, {nan, 1e-3}, 0.0, kNone));
  EXPECT_FALSE(fit_order({0.1}, {1e-3}, 0.0, kNone));
  EXPECT_FALSE(fit_order({0.1, 0.05}, {1e-15, 1e-15}, 1e-15, kNone));
}

}  // namespace
}  // namespace tumble::testing
