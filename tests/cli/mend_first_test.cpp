// The head of a graded page: causes with what they cost, for a teaching assistant and for a
// student.
#include <gtest/gtest.h>

#include <limits>
#include <set>

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
  EXPECT_NE(html.find("This mistake alone explains both failed tests, with the same wrong "
                      "answers."),
            std::string::npos);
  EXPECT_NE(html.find("2 tests failed (wrong, crashed, or out of time or memory)."),
            std::string::npos);
  EXPECT_NE(html.find("hit begins in line 7 of a9_things.cpp."), std::string::npos);
}

TEST_F(MendFirst, ACauseWithoutANumberThatAgreesIsOnlyPossible) {
  grade.causes[0].same_numbers = 0;
  const std::string html = page(grade);
  EXPECT_EQ(html.find("Likely mistake"), std::string::npos);
  EXPECT_NE(html.find("1. hit gives wrong answers (the mistake is not certain)"),
            std::string::npos);
  EXPECT_NE(html.find("One way to fail both failed tests: the factor is missing. But it "
                      "gives other numbers than yours"),
            std::string::npos);
}

// "Your mistake may be another one" above an equation that names it would contradict it.
TEST_F(MendFirst, NumbersThatTheEquationExplainsAreNotCalledThoseOfAnotherMistake) {
  grade.causes[0].same_numbers = 0;
  grade.tests[0].result.story +=
      "\n  x-ray:    j = 2 m u\n            2   2   <- your answer comes out without this term\n";
  const std::string html = page(grade);
  EXPECT_NE(html.find("But alone it gives other numbers than yours: the equation below marks how "
                      "yours come out."),
            std::string::npos)
      << html;
  EXPECT_EQ(html.find("another one"), std::string::npos);
}

TEST_F(MendFirst, ACauseThatNoMistakeExplainsNamesTheOneThatGivesItsAnswers) {
  Cause other = grade.causes[0];
  other.kind = Cause::Kind::kUnknown;
  other.tests = {"Open.Hit"};
  other.may_follow = {{0, 1}};
  grade.causes.push_back(other);
  const std::string html = page(grade);
  EXPECT_NE(html.find("The mistake of cause 1 gives the same wrong answer in its test: mend that "
                      "one first, this may follow from it."),
            std::string::npos)
      << html;
  EXPECT_NE(html.find("1 of the 2 failed tests called this function last."), std::string::npos);
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

std::set<std::string> targets_in(const std::string& html, const std::string& before) {
  std::set<std::string> names;
  for (std::size_t at = html.find(before); at != html.npos; at = html.find(before, at + 1)) {
    const std::size_t begin = at + before.size();
    names.insert(html.substr(begin, html.find('"', begin) - begin));
  }
  return names;
}

// Of tests with a story, without one, hidden and not attempted; of scenes, in both kinds of page.
TEST_F(MendFirst, EveryLinkWithinThePageLeadsSomewhere) {
  grade.tests.push_back(scored("Open.New", "a new one", 1, Verdict::kNotAttempted, false,
                               "hit: not implemented yet"));
  grade.tests.push_back(scored("Open.Late", "a late one", 1, Verdict::kOutOfResources, false,
                               "not run: the tests before used up the time"));
  grade.tests.back().result.not_run = true;
  grade.causes[0].tests.push_back("Open.New");
  grade.causes[0].not_run = {"Open.Late"};
  SceneMedia scene;
  scene.scene = "two_boxes";
  scene.title = "Two boxes";
  scene.story = "SIGSEGV";
  scene.functions = {"hit"};
  grade.media = {scene};
  for (const Grade& shown : {grade, for_student(grade)}) {
    const std::string html = page(shown);
    const auto ids = targets_in(html, " id=\""), links = targets_in(html, "href=\"#");
    for (const std::string& link : links) EXPECT_TRUE(ids.contains(link)) << link;
    EXPECT_TRUE(links.contains("r-Open-New"));
    EXPECT_TRUE(links.contains("s-two-boxes"));
    EXPECT_TRUE(links.contains(shown.tests[1].item.test == "Secret.Seam" ? "t-Secret-Seam"
                                                                         : "r-Hidden-Test1"));
    EXPECT_NE(html.find("All 4 tests of this cause</summary>"), std::string::npos);
  }
}

// A run in which two mistakes act may show the other one's.
TEST_F(MendFirst, APictureStandsBesideTheOneCauseThatActsInItsScene) {
  SceneMedia scene;
  scene.scene = scene.title = "boxes";
  scene.story = "SIGSEGV";
  scene.picture = "boxes.png";
  scene.functions = {"hit", "turn"};
  grade.media = {scene};
  const auto box = [&] {
    const std::string html = page(grade);
    return html.substr(0, html.find("id=\"tests\""));
  };
  EXPECT_NE(box().find("media/boxes.png"), std::string::npos);
  Cause other;
  other.kind = Cause::Kind::kUnknown;
  other.says = "turn gives wrong answers";
  other.functions = {"turn"};
  other.tests = {"Secret.Seam"};
  grade.causes.push_back(other);
  EXPECT_EQ(box().find("media/boxes.png"), std::string::npos);
  EXPECT_NE(box().find("boxes</a> (cause 2 may act in it, too)"), std::string::npos) << box();
  other.functions = {"turn", "spin"};
  scene.functions.push_back("spin");
  grade.media = {scene};
  grade.causes.push_back(other);
  EXPECT_NE(box().find("boxes</a> (causes 2, 3 may act in it, too)"), std::string::npos) << box();
}

// No record says which of two mistakes in one function a run shows. The one that costs more has it.
TEST_F(MendFirst, OfCausesOfOneFunctionTheFirstAloneNamesItsScenes) {
  SceneMedia scene;
  scene.scene = scene.title = "boxes";
  scene.story = "SIGSEGV";
  scene.picture = "boxes.png";
  scene.functions = {"hit"};
  grade.media = {scene};
  Cause rare = grade.causes[0];
  rare.says = "two walls meet";
  grade.causes.push_back(rare);
  const std::string html = page(grade), box = html.substr(0, html.find("id=\"tests\""));
  const std::size_t first = box.find("boxes</a>");
  EXPECT_NE(first, std::string::npos);
  EXPECT_LT(first, box.find("id=\"cause-2\""));
  EXPECT_EQ(box.find("boxes</a>", first + 1), std::string::npos);
  EXPECT_EQ(box.find("may act in it"), std::string::npos);
  EXPECT_EQ(box.find("media/boxes.png"), std::string::npos);  // it may show either
}

// A cause that is no known slip gives something to act on, too.
TEST_F(MendFirst, EveryCauseSaysWhatItShouldBeAndWhereToRead) {
  FunctionInHeader told;
  told.purpose = "How hard it hits.\nj = 2 u   (A9.2)";
  told.formula = "j = 2 u   (A9.2)";
  told.returns = "j, not below 0";
  told.equations = {"handouts/a9_things.md#eq-a9-2"};
  told.hints = "handouts/a9_things.md#hint-hit";
  for (const auto kind : {Cause::Kind::kUnknown, Cause::Kind::kOutOfResources, Cause::Kind::kCrash,
                          Cause::Kind::kNotWritten, Cause::Kind::kSlip}) {
    grade.causes[0].kind = kind;
    grade.causes[0].told = {told};
    grade.causes[0].tests = {"Secret.Seam"};
    const std::string html = page(for_student(grade), {"../handout.html", "a9_things"});
    const bool is_new = kind == Cause::Kind::kNotWritten;
    EXPECT_NE(html.find(is_new ? "<dt>to write</dt><dd>How hard it hits.\nj = 2 u"
                               : "<dt>it should be</dt><dd>j =\u00a02 u   (A9.2)</dd>"),
              std::string::npos)
        << html;
    EXPECT_EQ(html.find("<dt>it returns</dt><dd>j, not below 0") != std::string::npos, is_new);
    EXPECT_NE(html.find("../handout.html#eq-a9-2\">equation (A9.2) of the handout"),
              std::string::npos);
    EXPECT_NE(html.find("../handout.html#hint-hit"), std::string::npos);
    EXPECT_EQ(html.find("Seen by hidden tests only") != std::string::npos, !is_new);
  }
}

TEST_F(MendFirst, CausesThatBelongTogetherSaySo) {
  Cause other = grade.causes[0];
  other.says = "the sign is wrong";
  grade.causes.push_back(other);
  grade.causes[0].also_needed = {{1, 1}};
  const std::string html = page(grade);
  EXPECT_NE(html.find("1 of its tests also needs cause 2 mended."), std::string::npos) << html;
  EXPECT_NE(html.find("Cause 2 is about the same function"), std::string::npos);
  EXPECT_NE(html.find("Cause 1 is about the same function"), std::string::npos);
}

// A fault names its body in quotation marks, a number of the scene does not: one column, one style.
TEST_F(MendFirst, ABodyOfATableStandsWithoutQuotationMarks) {
  SceneMedia scene;
  scene.scene = scene.title = "boxes";
  scene.checks.resize(2);
  scene.checks[0].subject = "'handle'";
  scene.checks[1].subject = "'left' and 'right'";
  grade.media = {scene};
  const std::string html = page(grade);
  EXPECT_NE(html.find(">handle</td>"), std::string::npos);
  EXPECT_NE(html.find("&#39;left&#39; and &#39;right&#39;</td>"), std::string::npos);
}

// A smaller step mends no wrong law.
TEST_F(MendFirst, AFaultOfARunIsNoRemedyOfAStepWhereALawIsWrong) {
  SceneMedia scene;
  scene.scene = scene.title = "boxes";
  engines::CheckResult flips;
  flips.kind = "flips";
  flips.passed = false;
  flips.value = 22;
  flips.threshold = 0;
  flips.why = "what rises is made by the step. Likely remedy: a step of at most 0.004 s";
  flips.detail = "25 flips, expected 3";
  scene.checks = {flips};
  grade.media = {scene};
  const std::string html = page(grade);
  EXPECT_EQ(html.find("0.004"), std::string::npos);
  EXPECT_NE(html.find("Mend first what stands at the head of this page."), std::string::npos);
  EXPECT_NE(html.find("off by 22, allowed 0"), std::string::npos);
  grade.causes.clear();
  EXPECT_NE(page(grade).find("Likely remedy: a step of at most 0.004 s."), std::string::npos);
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
  EXPECT_NE(html.find("0.323\u00a0kg\u00a0m^2/s, allowed at most <span "
                      "class=\"unbroken\">1e-9</span>\u00a0kg\u00a0m^2/s"),
            std::string::npos);
  EXPECT_NE(html.find("At t = 0.933 s. Here e = 1, and rods do no work."), std::string::npos);
  EXPECT_NE(html.find("no number, allowed at least <span "
                      "class=\"unbroken\">1e-9</span>\u00a0kg\u00a0m^2/s"),
            std::string::npos);
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
