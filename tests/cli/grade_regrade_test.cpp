// Points alone are added up again; nothing is run.
#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/grading/grades/grade.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/grade_submission.h"
#include "framework/grading/grades/lowering.h"
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

// A new result of the file "s" beside an earlier one.
class Placed : public ::testing::Test {
 protected:
  static GradeRecord record(double score, const std::string& submission = "s") {
    GradeRecord record;
    record.key.submission = submission;
    record.grade.state = GradeState::kJudged;
    record.grade.score = score;
    return record;
  }
  static GradeRecord unfinished() {
    GradeRecord fault = record(0.0);
    fault.grade.state = GradeState::kGraderFault;
    return fault;
  }
  void put_earlier(const GradeRecord& earlier) { work.earlier.record = earlier; }
  Placing of(const GradeRecord& now, const LedgerScore* last = nullptr, bool is_place_taken = true,
             bool guards = false) const {
    return placing_of(work, now, {last, guards, is_place_taken});
  }
  GradedWork work;
  const LedgerScore seventy{"s", 70.0}, of_another_file{"t", 70.0};
};

TEST_F(Placed, AFinalResultIsPutInPlaceUnlessItLowersTheScoreOfTheSameFile) {
  EXPECT_EQ(of(record(70.0), &seventy), Placing::kNew);
  EXPECT_EQ(of(record(60.0), &seventy), Placing::kAsk);
  EXPECT_EQ(of(record(60.0), &of_another_file), Placing::kNew);
  EXPECT_EQ(of(record(60.0), &of_another_file, true, true), Placing::kAsk);
  put_earlier(record(80.0));
  EXPECT_EQ(of(record(75.0), &seventy), Placing::kAsk);
  EXPECT_EQ(of(record(85.0), &seventy), Placing::kNew);
  put_earlier(record(80.0, "t"));
  EXPECT_EQ(of(record(75.0)), Placing::kNew);
}

TEST_F(Placed, AFaultOfTheGraderLeavesAnEarlierResultOfTheSameFile) {
  put_earlier(record(80.0));
  EXPECT_EQ(of(unfinished(), &seventy), Placing::kEarlier);
  put_earlier(record(80.0, "t"));
  EXPECT_EQ(of(unfinished()), Placing::kNew);
  put_earlier(unfinished());
  EXPECT_EQ(of(unfinished(), &seventy), Placing::kNew) << "two pages of faults: the later one";
}

// Its result was signed by a key that is lost, or has changed.
TEST_F(Placed, AFaultOfTheGraderLeavesWhatHasTheLedgersScoreAndDoesNotCount) {
  work.earlier.problem = "its record is not signed by this machine's key";
  EXPECT_EQ(of(unfinished(), &seventy), Placing::kUntouched);
  EXPECT_EQ(of(unfinished(), &of_another_file), Placing::kNew);
  EXPECT_EQ(of(unfinished(), nullptr), Placing::kNew);
  EXPECT_EQ(of(unfinished(), &seventy, false), Placing::kNew) << "nothing lies there";
}

TEST_F(Placed, VerdictsOfAnEarlierResultStandWhereItsKeysAreTheSameAndNothingIsMissing) {
  const GradeOptions options;  // with pictures
  GradeRecord earlier = record(80.0);
  earlier.key = work.key = {"s", "judging", "rubric", "pictures"};
  put_earlier(earlier);
  EXPECT_TRUE(is_current(work, options));
  EXPECT_FALSE(is_current_but_for_a_stage(work, options)) << "nothing is missing";

  earlier.grade.faults = {"the pictures: no ffmpeg"};
  put_earlier(earlier);
  EXPECT_FALSE(is_current(work, options));
  EXPECT_TRUE(is_current_but_for_a_stage(work, options));
  earlier.key.pictures.clear();
  put_earlier(earlier);
  EXPECT_TRUE(is_current_but_for_a_stage(work, options)) << "its process died at the pictures";

  for (std::string GradeKey::*part :
       {&GradeKey::submission, &GradeKey::judging, &GradeKey::rubric, &GradeKey::pictures}) {
    GradeRecord other = earlier;
    other.key.*part = "another";
    put_earlier(other);
    EXPECT_FALSE(is_current_but_for_a_stage(work, options));
  }
  earlier.grade.state = GradeState::kGraderFault;
  put_earlier(earlier);
  EXPECT_FALSE(is_current_but_for_a_stage(work, options)) << "it has no verdicts";
}

TEST_F(Placed, WhatIsHeldHasNoScoreAlsoWhenItIsReadAgain) {
  Submission submission;
  submission.name = "ada";
  work.submission = &submission;
  work.folder = "ada";
  const GradeRecord held = held_record(work, "a9", rubric(60, 40), "not lowered (70 -> 60: why)");
  const PrivateFolder out;
  const std::string key(32, 'k');
  write_whole(out.path() / "ada/record.json", record_json(held, key));
  const EarlierRun read = read_earlier_run(out.path() / "ada", "a9", key);
  ASSERT_TRUE(read.record) << read.problem;
  EXPECT_TRUE(read.record->grade.is_held);
  EXPECT_FALSE(read.record->grade.has_score());
  EXPECT_EQ(read.record->grade.change, "not lowered (70 -> 60: why)");
  EXPECT_EQ(gradescope_json(held.grade).find("lower"), std::string::npos) << "students read it";
}

}  // namespace
}  // namespace tumble::grading
