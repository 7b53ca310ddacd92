// The head of a graded page: causes with what they cost, for a teaching assistant and for a
// student.
#include <gtest/gtest.h>

#include <limits>

#include "framework/grading/grades/class_facts.h"
#include "framework/grading/grades/grade_pages.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::grading::mend_first_test {
namespace {

ScoredTest scored(const std::string& name, const std::string& title, double points, Verdict verdict,
                  bool hidden, const std::string& story = "") {
  ScoredTest test;
  test.item = {name, points, "basic", title, hidden};
  test.result.test = name;
  test.result.verdict = verdict;
  test.result.story = story;
  test.score = verdict == Verdict::kRight ? points : 0.0;
  return test;
}

class MendFirst : public ::testing::Test {
 protected:
  MendFirst() {
    kind.id = "a9";
    kind.folder = "a9_things";
    kind.title = "Things";
    grade.name = "ada";
    grade.state = GradeState::kJudged;
    grade.tests = {
        scored("Open.Hit", "a central hit", 4, Verdict::kWrong, false,
               "\n  scene:    a ball\n  found:    6\n  read:     handouts/a9_things.md#eq-2"),
        scored("Secret.Seam", "the seam", 5, Verdict::kWrong, true, "the seam leaks"),
        scored("Open.Miss", "a miss", 3, Verdict::kRight, false)};
    Cause cause;
    cause.kind = Cause::Kind::kSlip;
    cause.says = "the factor is missing";
    cause.functions = {"hit"};
    cause.places = {"a9_things.cpp:7"};
    cause.tests = {"Open.Hit", "Secret.Seam"};
    cause.same_numbers = 2;
    grade.causes = {cause};
    add_up(grade);
  }
  std::string page(const Grade& shown, const PageView& view = {}) const {
    return submission_page(kind, shown, "", view).html();
  }

  modules::ModuleKind kind;
  Grade grade;
};

TEST_F(MendFirst, StandsBeforeTheTestsWithPointsEvidenceAndPlace) {
  const std::string html = page(grade);
  const auto box = html.find("Mend first</h2>");
  ASSERT_NE(box, std::string::npos);
  EXPECT_LT(box, html.find("id=\"tests\""));
  EXPECT_NE(html.find("1. Likely mistake in hit: the factor is missing (9 points)"),
            std::string::npos);
  EXPECT_NE(html.find("A file with this mistake fails 2 of the 2 tests that this file fails, and "
                      "gives in all of them the same wrong answer as this file."),
            std::string::npos);
  EXPECT_NE(html.find("Look at hit, a9_things.cpp:7."), std::string::npos);
}

TEST_F(MendFirst, ACauseWithoutANumberThatAgreesIsOnlyPossible) {
  grade.causes[0].same_numbers = 0;
  const std::string html = page(grade);
  EXPECT_EQ(html.find("Likely"), std::string::npos);
  EXPECT_NE(html.find("Possible mistake in hit"), std::string::npos);
  EXPECT_NE(html.find("though with other answers"), std::string::npos);
}

TEST_F(MendFirst, SaysWhatFollowsAndWhatWasNotRunWithoutNamesOfHiddenTests) {
  grade.causes[0].tests = {"Open.Hit"};
  grade.causes[0].following = {"Secret.Seam"};
  const std::string follows = page(for_student(grade));
  EXPECT_NE(follows.find("One more test fails, of functions that ask hit"), std::string::npos)
      << follows;
  EXPECT_NE(follows.find("(9 points)"), std::string::npos);
  EXPECT_EQ(follows.find("Secret"), std::string::npos);
  std::swap(grade.causes[0].following, grade.causes[0].not_run);
  const std::string not_run = page(for_student(grade));
  EXPECT_NE(not_run.find("One more test was not run"), std::string::npos) << not_run;
  EXPECT_EQ(not_run.find("Secret"), std::string::npos);
}

TEST_F(MendFirst, WhatIsRightIsFolded) {
  const std::string html = page(grade);
  const auto fold = html.find("1 test right: 3 points</summary>");
  ASSERT_NE(fold, std::string::npos);
  EXPECT_GT(html.find("a miss"), fold);
}

// Where a scene is to be looked at, those that are right are folded behind it; the arguments of a
// call that ended a run fill no screen.
TEST_F(MendFirst, ScenesThatAreRightAreFolded) {
  SceneMedia right, stopped;
  right.scene = "right";
  right.title = "A right scene";
  stopped.scene = "stopped";
  stopped.title = "A scene that stopped";
  stopped.story = "SIGSEGV, in hit, a9_things.cpp:7\n  called with: x = 3";
  grade.media = {right, stopped};
  const std::string html = page(grade);
  const auto fold = html.find("1 scene is right</summary>");
  ASSERT_NE(fold, std::string::npos);
  EXPECT_GT(html.find("A right scene"), fold);
  EXPECT_LT(html.find("A scene that stopped"), fold);
  EXPECT_NE(html.find("ended early: SIGSEGV, in hit, a9_things.cpp:7.</p>"), std::string::npos);
  EXPECT_NE(html.find("called with: x = 3"), std::string::npos);
  grade.media = {right};
  EXPECT_EQ(page(grade).find("1 scene is right"), std::string::npos);
}

TEST_F(MendFirst, ANumberOfASceneIsToldInSentences) {
  SceneMedia scene;
  scene.scene = scene.title = "boxes";
  engines::CheckResult wrong;
  wrong.kind = "angular_momentum";
  wrong.passed = false;
  wrong.subject = "all";
  wrong.value = 0.3234;
  wrong.threshold = 1e-9;
  wrong.unit = "kg m^2/s";
  wrong.why = "both impulses act at the same point: round-off only";
  wrong.detail = "at t = 0.933 s";
  engines::CheckResult symbols = wrong;
  symbols.value = std::numeric_limits<double>::infinity();
  symbols.at_least = true;
  symbols.why = "e = 1, and rods do no work";
  scene.checks = {wrong, symbols};
  grade.media = {scene};
  const std::string html = page(grade);
  EXPECT_NE(html.find("At t = 0.933 s. Both impulses act at the same point: round-off only."),
            std::string::npos)
      << html;
  EXPECT_NE(html.find("0.323 kg m^2/s, allowed at most 1e-9 kg m^2/s"), std::string::npos);
  EXPECT_NE(html.find("At t = 0.933 s. Here e = 1, and rods do no work."), std::string::npos);
  EXPECT_NE(html.find("no number, allowed at least 1e-9 kg m^2/s"), std::string::npos);
}

// As at the scene's own picture.
TEST_F(MendFirst, TheArgumentsThatEndedACostAreFolded) {
  grade.cost.scene = "A free top";
  grade.cost.lines = {line_that_says(
      "your rk4: the refinement sequence ended early: no answer within 3 s\n  called with: t = 1")};
  const std::string html = page(grade);
  EXPECT_NE(
      html.find(
          "Your rk4: the refinement sequence ended early: no answer within 3 s.</p>\n<details"),
      std::string::npos)
      << html;
  EXPECT_NE(html.find("<pre>  called with: t = 1</pre></details>"), std::string::npos) << html;
}

TEST_F(MendFirst, AStudentSeesTheCauseAndNothingOfAHiddenTest) {
  const std::string html = page(for_student(grade));
  for (const char* word : {"Secret", "seam"}) EXPECT_EQ(html.find(word), std::string::npos) << word;
  EXPECT_NE(html.find("the factor is missing (9 points)"), std::string::npos);
  EXPECT_NE(html.find("Hidden test 1"), std::string::npos);
}

TEST_F(MendFirst, AStoryLeadsToTheHandoutOfTheReport) {
  EXPECT_EQ(page(grade).find("<a href=\"../handout.html"), std::string::npos);
  EXPECT_NE(page(grade, {"../handout.html", "a9_things"})
                .find("<a href=\"../handout.html#eq-2\">equation (2) of the handout</a>"),
            std::string::npos);
}

}  // namespace
}  // namespace tumble::grading::mend_first_test
