/// A failing test tells its story: what was set up, what was expected, what came, the likely slip, where to read.
///
///   const Story story{.scene = "a 2 kg ball at 3 m/s hits a wall, e = 0.5",
///                     .slip = "forgetting the (1 + e)", .handout = "handouts/a1_impulse.md#eq-a1-8"};
///   expect_near(a1().collision_impulse(...), 9.0, 10 * kEps * 9.0, "N s", story);
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/math.h"

namespace tumble::testing {

inline constexpr double kEps = 2.220446049250313e-16;  // spacing of doubles at 1

struct Story {
  std::string scene = "";     // what was set up, with numbers and units
  std::string steps = "";     // what was done to it, where more than one call
  std::string slip = "";      // the mistake that gives such an answer most often
  std::string handout = "";   // file and anchor
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

/// Fails the test with this story. The first three say it; more of them would only hide the next test's.
inline void report_failure(const std::string& told) {
  constexpr int kStoriesATest = 3;
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const int told_before = test ? test->result()->total_part_count() : 0;
  const bool is_last = told_before == kStoriesATest - 1;
  if (told_before < kStoriesATest) ADD_FAILURE() << told << (is_last ? "\n  more:     what else may differ in this test is left out" : "");
}

/// Absolute comparison. NaN never passes.
inline void expect_near(double found, double expected, double tolerance, const std::string& unit, const Story& story) {
  const double difference = std::abs(found - expected);
  if (difference <= tolerance) return;
  report_failure(tell(story, show(expected), show(found), unit, show(difference) + " (allowed " + show(tolerance) + ")"));
}

/// Largest component.
template <class A, class B>
void expect_near(const Eigen::MatrixBase<A>& found, const Eigen::MatrixBase<B>& expected, double tolerance, const std::string& unit,
                 const Story& story) {
  const bool same_size = found.rows() == expected.rows() && found.cols() == expected.cols();
  const double difference = same_size && found.allFinite() ? (found - expected).cwiseAbs().maxCoeff() : std::nan("");
  if (difference <= tolerance) return;
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

inline void expect_true(bool holds, const std::string& expected, const std::string& found, const Story& story) {
  if (!holds) report_failure(tell(story, expected, found, ""));
}

}  // namespace tumble::testing
