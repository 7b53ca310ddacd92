/// A failing test tells its story: what was set up, what was expected, what came, the likely slip, where to read.
///
///   const Story story{.scene = "a 2 kg ball at 3 m/s hits a wall, e = 0.5",
///                     .slip = "forgetting the (1 + e)", .handout = "handouts/a1_impulse.md#eq-a1-8"};
///   expect_near(a1().collision_impulse(...), 9.0, 10 * kEps * 9.0, "N s", story);
#pragma once

#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/math.h"

namespace tumble::testing {

inline constexpr double kEps = 2.220446049250313e-16;  // spacing of doubles at 1

struct Story {
  std::string scene = "";     // what was set up, with numbers and units
  std::string steps = "";     // what was done to it, where more than one call
  std::string slip = "";      // the mistake that gives such an answer most often
  std::string handout = "";   // file and anchor
  std::string no_number = ""; // the mistake where NaN or infinity came; empty: nothing special to this scene
  bool iterates = false;      // the answer comes from an iteration, whose error may have any size: see slip_in_the_digits
};

inline std::string tell(const Story& story, const std::string& expected, const std::string& found, const std::string& unit,
                        const std::string& difference = "") {
  std::ostringstream text;
  text << "\n  scene:    " << story.scene;
  if (!story.steps.empty()) text << "\n  steps:    " << story.steps;
  const std::string with_unit = unit.empty() ? "" : ' ' + unit;
  text << "\n  expected: " << expected << with_unit << "\n  found:    " << found << with_unit;
  if (!difference.empty()) text << "\n  off by:   " << difference;
  if (!story.slip.empty()) text << "\n  likely:   " << story.slip;
  if (!story.handout.empty()) text << "\n  read:     " << story.handout;
  return text.str();
}

inline std::string show(double x) {
  std::ostringstream text;
  text.precision(12);
  text << x;
  return text.str();
}

template <class Derived>
std::string show(const Eigen::MatrixBase<Derived>& m) {
  static const Eigen::IOFormat format(12, Eigen::DontAlignCols, ", ", "; ", "", "", "(", ")");
  std::ostringstream text;
  text << m.eval().format(format);
  return text.str();
}

// ---- Slips that show in the numbers themselves, whatever the function ------------------------------------------------------

inline const std::string kNoNumber =
    "no number came out (NaN or infinity): a variable that was never set, 0 / 0, an infinite mass multiplied, or the root of a negative number";
inline const std::string kFloat = "float where double belongs: the relative error is that of float's 24 bits, about 6e-8";
inline const std::string kKept =
    "something is kept between calls (a static or global variable, or a reference to one): the first call is answered rightly, and a later one with what the first one left";

/// What the digits of a wrong answer alone say: no number, or float. Empty where they say neither.
/// Float is named where every component is a float exactly and near the expected one, which is not; or where the error is a few of
/// float's roundings (2^-24) and the test allows none of that size. The error of an iteration proves nothing: there only the bits do.
template <class A, class B>
std::string slip_in_the_digits(const Eigen::MatrixBase<A>& found, const Eigen::MatrixBase<B>& expected, double tolerance, const Story& story) {
  if (!found.allFinite()) return story.no_number.empty() ? kNoNumber : story.no_number;
  const double scale = expected.cwiseAbs().maxCoeff(), error = (found - expected).cwiseAbs().maxCoeff();
  constexpr double kFloatEps = 0x1p-24;
  if (!(scale > 0) || error > 16 * kFloatEps * scale) return "";
  const auto is_float = [](const auto& v) { return v.template cast<float>().template cast<double>().cwiseEqual(v).all(); };
  const bool shows_in_bits = is_float(found.derived().eval()) && !is_float(expected.derived().eval());
  const bool shows_in_size = !story.iterates && error > kFloatEps / 256 * scale && tolerance < kFloatEps / 4096 * scale;
  return shows_in_bits || shows_in_size ? kFloat : "";
}

/// Fails the test with this story. The first three say it; more of them would only hide the next test's.
inline void report_failure(const std::string& told) {
  constexpr int kStoriesATest = 3;
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const int told_before = test ? test->result()->total_part_count() : 0;
  const bool is_last = told_before == kStoriesATest - 1;
  if (told_before < kStoriesATest) ADD_FAILURE() << told << (is_last ? "\n  more:     what else may differ in this test is left out" : "");
}

/// The story with another slip; as it is where that is empty.
inline Story with_slip(Story story, const std::string& slip) {
  if (!slip.empty()) story.slip = slip;
  return story;
}

/// Absolute comparison. NaN never passes.
inline void expect_near(double found, double expected, double tolerance, const std::string& unit, const Story& story) {
  const double difference = std::abs(found - expected);
  if (difference <= tolerance) return;
  using One = Eigen::Matrix<double, 1, 1>;
  const std::string seen = slip_in_the_digits(One(found), One(expected), tolerance, story);
  report_failure(tell(with_slip(story, seen), show(expected), show(found), unit, show(difference) + " (allowed " + show(tolerance) + ")"));
}

/// Largest component.
template <class A, class B>
void expect_near(const Eigen::MatrixBase<A>& found, const Eigen::MatrixBase<B>& expected, double tolerance, const std::string& unit,
                 const Story& given) {
  const bool same_size = found.rows() == expected.rows() && found.cols() == expected.cols();
  const double difference = same_size && found.allFinite() ? (found - expected).cwiseAbs().maxCoeff() : std::nan("");
  if (difference <= tolerance) return;
  const Story story = same_size ? with_slip(given, slip_in_the_digits(found, expected, tolerance, given)) : given;
  const std::string off_by = show(difference) + " (allowed " + show(tolerance) + ")";
  constexpr Eigen::Index kReadable = 16;  // numbers in a line
  if (same_size && expected.size() > kReadable && found.allFinite()) {
    Eigen::Index row = 0, column = 0;
    (found - expected).cwiseAbs().maxCoeff(&row, &column);
    const std::string where = " at [" + std::to_string(row) + "], the worst of " + std::to_string(expected.size());
    report_failure(tell(story, show(expected(row, column)) + where, show(found(row, column)), unit, off_by));
  } else {
    report_failure(tell(story, show(expected), show(found), unit, off_by));
  }
}

/// Two calls, the second about the same scene with other numbers: a function that answers the first rightly and the second with the
/// answer of the first (or with none) keeps something between calls. Call it for each function in a test of its own process.
template <class A, class B>
void expect_kept_nothing(const Eigen::MatrixBase<A>& first, const Eigen::MatrixBase<A>& expected_first, const Eigen::MatrixBase<B>& second,
                         const Eigen::MatrixBase<B>& expected_second, double tolerance, const std::string& unit, const Story& story) {
  const auto is_near = [](const auto& x, const auto& y, double allowed) { return x.size() == y.size() && (x - y).cwiseAbs().maxCoeff() <= allowed; };
  expect_near(first, expected_first, tolerance, unit, story);
  const bool kept = is_near(first, expected_first, tolerance) && !is_near(second, expected_second, tolerance);
  expect_near(second, expected_second, tolerance, unit, with_slip(story, kept ? kKept : ""));
}

inline void expect_true(bool holds, const std::string& expected, const std::string& found, const Story& story) {
  if (!holds) report_failure(tell(story, expected, found, ""));
}

}  // namespace tumble::testing
