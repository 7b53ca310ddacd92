/// What the tests of a2 share: equations with known solutions, callbacks that keep a diary, and
/// words for the slip behind a wrong answer.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assignments/a2_integration/a2_integration.h"
#include "framework/core/random.h"
#include "framework/modules/under_test.h"
#include "tests/support/story.h"

namespace tumble::a2_testing {

// relative: at most 20 roundings in any correct order of evaluation
inline constexpr double kRoundoff = 20 * testing::kEps;

using namespace tumble::testing;

/// The module under test, whichever of its three bodies is behind it.
inline const a2::Module& a2_module() { return modules::under_test<a2::Module>(); }

/// Handout anchor of equation (A2.n).
inline std::string equation(int n) {
  return "handouts/a2_integration.md#eq-a2-" + std::to_string(n);
}

// ---- Words for a slip --------------------------------------------------------------------------

/// A wrong answer, and the slip that gives it.
template <class Value>
using Slips = std::vector<std::pair<Value, std::string>>;

inline double distance(double a, double b) { return std::abs(a - b); }
inline double distance(const Quaterniond& a, const Quaterniond& b) {
  return (a.coeffs() - b.coeffs()).norm();
}
template <class A, class B>
double distance(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() ? (a - b).norm() : INFINITY;
}

/// The words of the slip whose answer was found, as one that the answer shows; `otherwise`, which
/// is only something to look at, when it is none of them.
template <class Found, class Value = Found>
Mistake likely(const Found& found, const Slips<Value>& slips, const Mistake& otherwise) {
  for (const auto& [gives, words] : slips)
    if (distance(found, gives) <= 1e-9) return shown(words);
  return otherwise;
}

// ---- Steps -------------------------------------------------------------------------------------

using Step = std::function<VectorXd(const OdeFunction&, double t, const VectorXd& y, double h)>;

inline VectorXd vector(std::initializer_list<double> numbers) {
  return Eigen::Map<const VectorXd>(numbers.begin(), static_cast<Eigen::Index>(numbers.size()));
}

/// Every call of a derivative: when, where, and how often.
struct Diary {
  std::vector<double> times;
  std::vector<VectorXd> states;
  std::size_t calls() const { return times.size(); }
};
/// The same function, with each call written down.
OdeFunction noting(Diary& diary, OdeFunction f);
/// Answers call number i with slopes[i] whatever the arguments: what a step does with its slopes
/// shows bare.
OdeFunction scripted(Diary& diary, std::vector<VectorXd> slopes);

/// y(t_end) by `steps` equal steps of the method.
VectorXd integrate(const Step& step, const OdeFunction& f, double t_start, const VectorXd& y,
                   double t_end, int steps);
/// log2 of the error's fall at each doubling of the number of steps, `first_steps` being the
/// fewest.
std::vector<double> observed_orders(const Step& step, const OdeFunction& f, double t_start,
                                    const VectorXd& y, double t_end, const VectorXd& exact,
                                    int first_steps, int halvings);
/// Every order lies within `tolerance` of `order`, or the story is told with all of them.
void expect_orders(const std::vector<double>& found, double order, double tolerance,
                   const Story& story);

/// The lecture's logistic equation y' = 6 y - 0.007 y^2, y(0) = 10.
VectorXd logistic(double t, const VectorXd& y);
// y(0.5), exact to double precision
inline constexpr double kLogisticAtHalf = 164.276752310393929949275357847;
/// Euler's equations of a free top in its own axes: I w' = -w x (I w), moments 1, 2, 3 kg m^2. y =
/// w_body.
VectorXd free_top(double t, const VectorXd& omega_body);

/// What is wrong with the rk4_step under test, read off it: asked with slopes of which one is 1 and
/// the others 0, it shows the weight of each slope and where each stage is taken. `otherwise` where
/// weights and stages are right.
Mistake rk4_slip(const Mistake& otherwise);

// ---- Rigid bodies ------------------------------------------------------------------------------

/// Turns a third of a full turn about (1, 1, 1): x to y to z to x. Its numbers are exact, and so
/// are those of its matrix.
inline Quaterniond third_turn() { return {0.5, 0.5, 0.5, 0.5}; }
/// 2 kg, principal moments 1, 2, 4 kg m^2.
Inertia block();
/// 2 kg, lopsided: no axis of its body frame is a principal one.
///   I = (4, -2, -2; -2, 5, -1; -2, -1, 6) kg m^2,   I^-1 = (29, 14, 12; 14, 20, 8; 12, 8, 16) /
/// 64, exact
Inertia bracket();
/// A turn whose axis and angle are skew: (1, 2, 4, 2) / 5.
inline Quaterniond skew_turn() { return {0.2, 0.4, 0.8, 0.4}; }
inline const std::string kDiagonalAlone =
    "the diagonal of the tensor alone: products of inertia count, so use the whole matrix";
/// At rest at (5, 3, 1), not turned.
RigidBodyState resting();
inline Wrench no_wrench() { return {Vector3d::Zero(), Vector3d::Zero()}; }

Vector3d random_vector(Random& random, double size);
Quaterniond random_rotation(Random& random);

// ---- Impacts -----------------------------------------------------------------------------------

/// A gap with its rate and the time at which it closes.
struct Approach {
  std::string scene;
  ScalarFunction gap, gap_rate;
  double t_low = 0.0, t_high = kUnset;  // [s]
  double time_of_impact = kUnset;       // [s]
};

/// A ball dropped from rest, 5 m above the floor. The slope of the gap is 0 at the start.
Approach dropped_ball();
/// A ball of radius 0.5 m thrown up at 2 m/s from 5 m.
Approach thrown_ball();
/// A rod of 1.5 m that spins at 30 rad/s while it falls: both tips can hit.
Approach spinning_rod();

/// Counts the calls of a function of time, and remembers the earliest and the latest.
struct Looks {
  int calls = 0;
  double earliest = INFINITY, latest = -INFINITY;
};
ScalarFunction noting(Looks& looks, ScalarFunction f);

/// What every right answer satisfies: converged, open at `time`, within `tolerance` before the
/// impact; residual and evaluations true. `round_off` is the time by which rounding inside the gap
/// may move its root [s].
void expect_impact(const RootResult& found, const Approach& approach, const Looks& looks,
                   double tolerance, double round_off, const std::string& slip,
                   int equation_number);
/// Status kNoSignChange, no time, no search.
void expect_no_impact(const RootResult& found, const Looks& looks, const std::string& scene,
                      const std::string& slip);

/// A root finder on an approach, its looks counted: what both of them must do is asked of either.
using Finder = std::function<RootResult(const Approach&, double tolerance, Looks&)>;
/// kNotConverged with the last open time, wherever NaN stands: at either end, all over, around the
/// impact.
void expect_finder_notices_nan(const Finder& find);
/// The width of the bracket ends the search, not the size of the gap: the same approach in units of
/// 1e-12 and 1e12 m.
/// @param most  calls of the gap that it may take
void expect_finder_looks_at_the_bracket(const Finder& find, int most);
/// kNoSignChange where the gap is closed from the start, whether it opens or not.
void expect_finder_refuses_overlap(const Finder& find);

/// "No impact", "stays as it is" and "few calls" are answers only from a function that can find,
/// change and call something: a test whose right answer is such a nothing asks first for a case in
/// which something must come. What comes is judged elsewhere.
/// @return false when nothing came: the test has failed with that story, and should end
bool bisection_finds_something();
bool newton_finds_something();
bool a_body_moves();
bool rk4_moves();

std::string show(RootStatus status);
using tumble::testing::show;

}  // namespace tumble::a2_testing
