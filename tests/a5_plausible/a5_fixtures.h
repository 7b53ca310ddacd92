/// What the tests of a5 share: priors and proposals by their numbers, chains of a known law, and
/// words for the slip behind a wrong answer.
#pragma once

#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assignments/a5_plausible/a5_plausible.h"
#include "framework/core/math.h"
#include "framework/core/random.h"
#include "framework/modules/under_test.h"
#include "tests/support/story.h"

namespace tumble::a5_testing {

using namespace tumble::testing;
using namespace tumble::a5;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// relative: at most 20 roundings in any correct order of evaluation
inline constexpr double kRoundoff = 20 * kEps;

/// The module under test, whichever of its three bodies is behind it.
inline const Module& student() { return modules::under_test<Module>(); }

/// Handout anchor of equation (A5.n).
inline std::string equation(int n) { return "handouts/a5_plausible.md#eq-a5-" + std::to_string(n); }

/// A wrong answer, and the slip that gives it.
using Slips = std::vector<std::pair<double, std::string>>;
/// The words of the slip whose answer was found, as one that the answer shows; `otherwise`, which
/// is only something to look at, when it is none of them.
Mistake likely(double found, const Slips& slips, const Mistake& otherwise);

inline VectorXd vector(std::initializer_list<double> numbers) {
  return Eigen::Map<const VectorXd>(numbers.begin(), static_cast<Eigen::Index>(numbers.size()));
}

/// As testing::expect_near; where no number came, the test's own slip is the likely one.
inline void expect_answer(double found, double expected, double tolerance, const std::string& unit,
                          Story story) {
  if (story.no_number.empty()) story.no_number = story.slip.words;
  testing::expect_near(found, expected, tolerance, unit, story);
}
inline void expect_answer(const VectorXd& found, const VectorXd& expected, double tolerance,
                          const std::string& unit, Story story) {
  if (story.no_number.empty()) story.no_number = story.slip.words;
  testing::expect_near(found, expected, tolerance, unit, story);
}

/// -infinity, and nothing else.
void expect_impossible(double log_density, const Story& story);
/// NaN where nothing is known.
void expect_unknown(double found, const Story& story);

// ---- Worlds and proposals ----------------------------------------------------------------------

inline Prior normal(double mean, double deviation, double low = -kInfinity,
                    double high = kInfinity) {
  return {PriorKind::kNormal, mean, deviation, low, high};
}
inline Prior uniform(double low, double high) {
  return {PriorKind::kUniform, kUnset, kUnset, low, high};
}
inline Move add(double size) { return {MoveKind::kAdd, size}; }
inline Move multiply(double size) { return {MoveKind::kMultiply, size}; }

/// Draws for a step of n numbers.
Draws draws_of(Random& random, Eigen::Index n);
/// Draws with these normals; the proposal with usual steps; accepted where it can be.
Draws draws_with(const VectorXd& normals, double choice = 0.9, double uniform = 0.0);

/// Every call of a density: where.
struct Calls {
  std::vector<VectorXd> places;
};
LogDensity noting(Calls& calls, LogDensity density);

/// What is wrong with the log_acceptance under test, read off plain cases. `otherwise` where they
/// are right.
Mistake acceptance_slip(const Mistake& otherwise);

// ---- Chains of a known law ---------------------------------------------------------------------

/// Independent standard normal numbers.
VectorXd independent(Random& random, Eigen::Index length);
/// x_(i+1) = phi x_i + sqrt(1 - phi^2) z_i, from a stationary start: standard normal, with
/// correlation phi^t at lag t.
VectorXd ar1(Random& random, double phi, Eigen::Index length);
/// As many of them.
std::vector<VectorXd> ar1_chains(std::uint64_t seed, double phi, int chains, Eigen::Index length);
/// Each chain through a function of one number.
std::vector<VectorXd> mapped(std::vector<VectorXd> chains,
                             const std::function<double(double)>& function);

/// Two short chains with the answers that are computed for them by hand in the handout.
std::vector<VectorXd> short_chains();

/// Chi-square of counts against expected ones: their sum of (found - expected)^2 / expected.
double chi_square(const std::vector<int>& found, const std::vector<double>& expected);

/// "Not known" and "impossible" are answers only from a function that gives numbers elsewhere: a
/// test whose right answer is such a nothing asks first for a case in which a number must come.
/// @return false when none came: the test has failed with that story, and should end
bool gives_numbers(double found, const std::string& scene, int equation_number);

}  // namespace tumble::a5_testing
