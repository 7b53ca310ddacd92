// What a student is told after a save: verdicts that changed, and the test to look at next.
#include <gtest/gtest.h>

#include "framework/grading/verdicts/what_changed.h"

namespace tumble::grading {
namespace {

TestResult verdict_of(const std::string& test, Verdict verdict) {
  TestResult result;
  result.test = test;
  result.verdict = verdict;
  return result;
}

Rubric rubric() {
  Rubric rubric;
  rubric.items = {
      {.test = "Impulse.Rotates", .points = 1, .level = "advanced", .title = "Rotation"},
      {.test = "Ray.Hits", .points = 1, .level = "basic", .title = "A ray hits"},
      {.test = "Ray.Misses", .points = 1, .level = "basic", .title = "A ray misses"},
      {.test = "Force.Turns", .points = 1, .level = "basic", .title = "Torque"}};
  return rubric;
}

TEST(WhatChanged, SaysWhatIsRightNowAndWhatIsNoLonger) {
  EXPECT_EQ(
      what_changed(
          {verdict_of("Ray.Hits", Verdict::kWrong), verdict_of("Ray.Misses", Verdict::kRight),
           verdict_of("Force.Turns", Verdict::kNotAttempted)},
          {verdict_of("Ray.Hits", Verdict::kRight), verdict_of("Ray.Misses", Verdict::kCrashed),
           verdict_of("Force.Turns", Verdict::kWrong)},
          rubric()),
      "now right: A ray hits; no longer right: A ray misses (crashed); now: Torque (wrong)");
}

TEST(WhatChanged, SaysThatNothingHas) {
  const std::vector<TestResult> same = {verdict_of("Ray.Hits", Verdict::kWrong)};
  EXPECT_EQ(what_changed(same, same, rubric()), "no verdict has changed");
}

// A loop in one function takes nothing from the tests that were not run for it.
TEST(WhatChanged, ATestThatWasNotRunIsNoLoss) {
  TestResult cut_off = verdict_of("Ray.Hits", Verdict::kOutOfResources);
  cut_off.not_run = true;
  const std::vector<TestResult> right = {verdict_of("Ray.Hits", Verdict::kRight)};
  EXPECT_EQ(what_changed(right, {cut_off}, rubric()),
            "no verdict has changed; 1 test not run, for want of time");
  EXPECT_EQ(what_changed({cut_off}, right, rubric()), "no verdict has changed");
  EXPECT_EQ(
      what_comes_next({cut_off, verdict_of("Impulse.Rotates", Verdict::kOutOfResources)}, rubric()),
      "Rotation [Impulse.Rotates]: out of time or memory");
}

// Another choice of tests on the command line is no change of the code.
TEST(WhatChanged, LeavesOutTestsThatOnlyOneRunHas) {
  EXPECT_EQ(what_changed({verdict_of("Ray.Hits", Verdict::kWrong)},
                         {verdict_of("Ray.Misses", Verdict::kRight)}, rubric()),
            "no verdict has changed");
}

TEST(WhatComesNext, IsWhatIsWrittenAndWrongBeforeWhatIsNotWritten) {
  EXPECT_EQ(what_comes_next({verdict_of("Ray.Hits", Verdict::kNotAttempted),
                             verdict_of("Impulse.Rotates", Verdict::kCrashed)},
                            rubric()),
            "Rotation [Impulse.Rotates]: crashed");
}

TEST(WhatComesNext, IsTheLowestLevelThenTheFirstOfTheRubric) {
  EXPECT_EQ(what_comes_next({verdict_of("Impulse.Rotates", Verdict::kWrong),
                             verdict_of("Force.Turns", Verdict::kWrong),
                             verdict_of("Ray.Misses", Verdict::kWrong),
                             verdict_of("Ray.Hits", Verdict::kRight)},
                            rubric()),
            "A ray misses [Ray.Misses]: wrong");
}

TEST(WhatComesNext, IsNothingWhereAllIsRight) {
  EXPECT_EQ(what_comes_next({verdict_of("Ray.Hits", Verdict::kRight)}, rubric()), "");
}

}  // namespace
}  // namespace tumble::grading
