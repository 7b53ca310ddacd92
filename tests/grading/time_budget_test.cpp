// The time account of a submission: charges, functions with shorter limits, results of the
// remaining tests. And patterns that select tests.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/grading/test_program/test_words.h"
#include "framework/grading/test_program/time_budget.h"

namespace tumble::grading {
namespace {

TestResult timed_out(const std::string& function, double limit_s) {
  TestResult result;
  result.verdict = Verdict::kOutOfResources;
  result.last_call = function;
  result.timed_out_s = limit_s;
  result.charged_s = limit_s + 0.7;  // measured on a loaded machine
  return result;
}

TEST(TimeBudget, TimeOutIsChargedItsLimitHoweverLongItTook) {
  TimeBudget budget({.budget_s = 10.0});
  budget.charge(timed_out("f", 5.0));
  EXPECT_FALSE(budget.is_used_up());
  budget.charge(timed_out("f", 4.0));  // 10.4 s measured
  EXPECT_FALSE(budget.is_used_up());
  budget.charge(timed_out("f", 1.0));
  EXPECT_TRUE(budget.is_used_up());
}

TEST(TimeBudget, QuickAnswersAreFreeAndSlowOnesAreCharged) {
  TimeBudget budget({.budget_s = 4.0});
  TestResult answered;
  answered.verdict = Verdict::kRight;
  answered.charged_s = 0.09;
  for (int i = 0; i < 1000; ++i) budget.charge(answered);
  EXPECT_FALSE(budget.is_used_up());
  answered.charged_s = 4.2;
  budget.charge(answered);
  EXPECT_TRUE(budget.is_used_up());
}

TEST(TimeBudget, ShortSleepInEachTestAddsUp) {
  TimeBudget budget({.budget_s = 60.0});
  TestResult answered;
  answered.verdict = Verdict::kRight;
  answered.charged_s = 0.9;
  for (int i = 0; i < 81; ++i) budget.charge(answered);
  EXPECT_TRUE(budget.is_used_up());
}

TEST(TimeBudget, BusyMachineIsNotCharged) {
  TimeBudget budget({.budget_s = 4.0});
  TestResult busy = timed_out("f", 0.0);
  busy.verdict = Verdict::kMachineBusy;
  busy.charged_s = 100.0;
  budget.charge(busy);
  EXPECT_FALSE(budget.is_used_up());
}

TEST(TimeBudget, FunctionThatTimedOutTwiceGetsAShorterLimit) {
  TimeBudget budget({.budget_s = 60.0, .full_timeouts = 2, .suspect_own_s = 1.0});
  budget.charge(timed_out("f", 5.0));
  budget.charge(timed_out("g", 5.0));
  EXPECT_TRUE(budget.suspects().empty());
  budget.charge(timed_out("f", 5.0));
  EXPECT_EQ(budget.suspects(), (std::map<std::string, double>{{"f", 1.0}}));
}

TEST(TimeBudget, TestThatIsNotRunHasAReason) {
  TimeBudget budget({.budget_s = 5.0});
  budget.charge(timed_out("f", 5.0));
  const TestResult result = budget.not_run("S.T");
  EXPECT_EQ(result.verdict, Verdict::kOutOfResources);
  EXPECT_TRUE(result.not_run);
  EXPECT_EQ(result.story,
            "not run: the time budget of all tests together, 5 s, was used up by the tests before "
            "it; functions that ran out of time: f (1 test)");
}

TEST(TestWords, PatternWithoutMatchNamesTheNearest) {
  const std::vector<std::string> tests = {"RayTriangle.Hits", "CollisionImpulse.Central",
                                          "ApplyImpulse.Turns"};
  EXPECT_EQ(chosen_tests(tests, "Ray*"), std::vector<std::string>{"RayTriangle.Hits"});
  EXPECT_EQ(chosen_tests(tests, ""), tests);
  try {
    chosen_tests(tests, "ColisionImpulse.*");
    ADD_FAILURE() << "selected tests";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("Nearest: CollisionImpulse.Central"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace tumble::grading
