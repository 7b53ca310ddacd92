// Points alone are added up again; nothing is run.
#include <gtest/gtest.h>

#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/grade_submission.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::grading {
namespace {

Rubric rubric(double open, double shut) {
  return {"a9",
          "Thing",
          {{"S.Open", open, "basic", "Open one", false},
           {"S.Shut", shut, "advanced", "Shut one", true}}};
}

Grade judged() {
  TestResult right, wrong;
  right.test = "S.Open";
  right.verdict = Verdict::kRight;
  wrong.test = "S.Shut";
  wrong.verdict = Verdict::kWrong;
  Grade grade;
  grade.state = GradeState::kJudged;
  grade.tests = score_tests(rubric(60, 40), {{right, wrong}, ""});
  add_up(grade);
  return grade;
}

TEST(Regrade, PointsAreAddedUpFromTheVerdictsThatStand) {
  const auto again = graded_by(rubric(30, 70), judged());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->score, 30.0);
  EXPECT_EQ(again->possible, 100.0);
  EXPECT_EQ(again->tests[1].result.verdict, Verdict::kWrong);
}

TEST(Regrade, ATestWithoutAVerdictMustBeRun) {
  Rubric more = rubric(30, 30);
  more.items.push_back({"S.New", 40.0, "basic", "New one", false});
  EXPECT_FALSE(graded_by(more, judged()));
}

TEST(Regrade, AFileThatDidNotCompileEarnsNothingUnderAnyPoints) {
  Grade grade;
  grade.state = GradeState::kDoesNotCompile;
  grade.story = "error";
  grade.tests =
      score_nothing(rubric(60, 40), Verdict::kWrong, "the file does not compile, so no test ran");
  const auto again = graded_by(rubric(30, 70), grade);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->score, 0.0);
  EXPECT_EQ(again->tests[1].result.story, "the file does not compile, so no test ran");
}

TEST(Regrade, DigestOfARubricSeesPoints) {
  EXPECT_EQ(rubric_digest(rubric(60, 40)), rubric_digest(rubric(60, 40)));
  EXPECT_NE(rubric_digest(rubric(60, 40)), rubric_digest(rubric(40, 60)));
}

}  // namespace
}  // namespace tumble::grading
