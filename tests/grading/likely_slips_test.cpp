// Failing tests matched to slips, by their names and by the answers that came.
#include <gtest/gtest.h>

#include <iterator>

#include <fmt/format.h>

#include "framework/grading/grades/causes.h"
#include "framework/grading/grades/likely_slips.h"
#include "framework/grading/grades/two_slips.h"

namespace tumble::grading {
namespace {

Failure wrong(const std::string& test, const std::string& found) {
  return {test, Verdict::kWrong, found, ""};
}

// Two slips that fail a common test, and one whose tests are all passed by who makes the others.
std::vector<AuditedSlip> slips() {
  return {{"e_forgotten",
           "the (1 + e) is missing",
           "collision_impulse",
           {wrong("Impulse.Central", "6 N s"), wrong("Impulse.Wall", "2 N s"),
            wrong("Resolve.Both", "(1, 0, 0) m/s")}},
          {"arm_sign",
           "F x r for r x F",
           "wrench_of_point_force",
           {wrong("Force.Torque", "(0, 0, -8) N m"), wrong("Resolve.Both", "(2, 0, 0) m/s")}},
          {"every_sign",
           "all is reversed",
           "",
           {wrong("Impulse.Central", "-9 N s"), wrong("Impulse.Wall", "-3 N s"),
            wrong("Force.Torque", "(0, 0, -8) N m"), wrong("Ray.Hit", "-1")}}};
}

std::vector<std::string> names(const std::vector<LikelySlip>& found) {
  std::vector<std::string> all;
  for (const LikelySlip& slip : found) all.push_back(slip.name);
  return all;
}

TEST(LikelySlips, NamesTheOneThatFailsTheSameTestsWithTheSameNumbers) {
  const auto found =
      likely_slips({wrong("Impulse.Central", "6.00000000001 N s"), wrong("Impulse.Wall", "2 N s"),
                    wrong("Resolve.Both", "(1, 0, 0) m/s")},
                   {{"Force.Torque", ""}, {"Ray.Hit", ""}}, slips());
  ASSERT_EQ(names(found), std::vector<std::string>{"e_forgotten"});
  EXPECT_EQ(found[0].tests.size(), 3u);
  EXPECT_EQ(found[0].same_numbers, 3u);
}

TEST(LikelySlips, NamesBothOfTwoWhoseCommonTestGivesAThirdAnswer) {
  const auto found = likely_slips(
      {wrong("Impulse.Central", "6 N s"), wrong("Impulse.Wall", "2 N s"),
       wrong("Force.Torque", "(0, 0, -8) N m"), wrong("Resolve.Both", "(7, 0, 0) m/s")},
      {{"Ray.Hit", ""}}, slips());
  EXPECT_EQ(names(found), (std::vector<std::string>{"e_forgotten", "arm_sign"}));
}

// Two tests agree with every_sign, but it would fail two others that are passed.
TEST(LikelySlips, PassedTestsThatASlipWouldFailWeighAgainstIt) {
  const auto found =
      likely_slips({wrong("Force.Torque", "(0, 0, -8) N m")},
                   {{"Impulse.Central", ""}, {"Impulse.Wall", ""}, {"Ray.Hit", ""}}, slips());
  EXPECT_EQ(names(found), std::vector<std::string>{"arm_sign"});
}

// The slip is in what two functions share; the submission made it in one of them, and the other is
// right.
TEST(LikelySlips, ASlipOfTwoFunctionsMayBeMadeInOneOfThem) {
  Failure central = wrong("Impulse.Central", "6 N s"), wall = wrong("Impulse.Wall", "2 N s");
  central.function = wall.function = "collision_impulse";
  const auto found =
      likely_slips({central, wall}, {{"Resolve.Both", "resolve_collision"}}, slips());
  ASSERT_EQ(names(found), std::vector<std::string>{"e_forgotten"});
  EXPECT_EQ(found[0].functions, std::vector<std::string>{"collision_impulse"});
  // in the same function it would be made in both
  EXPECT_NE(names(likely_slips({central}, {{"Impulse.Wall", "collision_impulse"}}, slips())),
            std::vector<std::string>{"e_forgotten"});
}

// Most of its tests ask another function last, which only uses the one with the slip.
TEST(LikelySlips, TheFunctionThatTheSlipIsInsideIsNamedFirst) {
  Failure central = wrong("Impulse.Central", "6 N s"), wall = wrong("Impulse.Wall", "2 N s"),
          both = wrong("Resolve.Both", "(1, 0, 0) m/s");
  central.function = "collision_impulse";
  wall.function = both.function = "resolve_collision";
  std::vector<AuditedSlip> known = slips();
  for (Failure& fails : known[0].fails)
    fails.function = fails.test == "Impulse.Central" ? "collision_impulse" : "resolve_collision";
  const auto found = likely_slips({central, wall, both}, {}, known);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].functions,
            (std::vector<std::string>{"collision_impulse", "resolve_collision"}));
}

TEST(LikelySlips, ACrashIsNotExplainedByASlipThatAnswersWrongly) {
  EXPECT_TRUE(likely_slips({{"Impulse.Central", Verdict::kCrashed, "SIGSEGV", ""},
                            {"Impulse.Wall", Verdict::kCrashed, "SIGSEGV", ""}},
                           {}, slips())
                  .empty());
}

TEST(LikelySlips, OneTestWithAnotherNumberProvesNothing) {
  EXPECT_TRUE(likely_slips({wrong("Impulse.Central", "17 N s")},
                           {{"Impulse.Wall", ""}, {"Force.Torque", ""}, {"Resolve.Both", ""}},
                           slips())
                  .empty());
}

TEST(LikelySlips, NumbersAgreeToAMillionthAndWordsExactly) {
  EXPECT_TRUE(is_same_answer("(1, 2.0000001, 3) m/s", "(1, 2, 3) m/s"));
  EXPECT_FALSE(is_same_answer("(1, 2.001, 3) m/s", "(1, 2, 3) m/s"));
  EXPECT_FALSE(is_same_answer("(1, 2) m/s", "(1, 2, 3) m/s"));
  EXPECT_TRUE(is_same_answer("nan", "nan"));
  EXPECT_FALSE(is_same_answer("a hit", "nothing"));
  EXPECT_FALSE(is_same_answer("", "9"));
}

TEST(LikelySlips, TheAnswerIsReadFromTheStory) {
  TestResult result;
  result.test = "S.T";
  result.verdict = Verdict::kWrong;
  result.story = "\n  scene:    a ball\n  expected: 9 N s\n  found:    6 N s\n  off by:   3";
  EXPECT_EQ(failure_of(result).found, "6 N s");
  result.verdict = Verdict::kCrashed;
  result.story = "SIGSEGV: Segmentation fault (an index), in intersect_ray_triangle";
  EXPECT_EQ(failure_of(result).found, "SIGSEGV");
}

// One hit: how hard, and what of it the denominator has.
struct Hit {
  double e, speed, masses, turning;
};
constexpr Hit kHits[] = {{0.5, 6.0, 1.0, 0.75},
                         {0.25, 4.0, 1.5, 2.0},
                         {0.8, 3.0, 0.5, 0.3},
                         {0.1, 7.0, 0.25, 0.6},
                         {0.6, 2.0, 3.0, 0.4}};
constexpr std::size_t kCount = std::size(kHits);

// j = (1 + e) v / (masses + turning), with mistakes made in it.
struct Mistakes {
  bool sign = false, e_for_one_plus_e = false, turning_forgotten = false, masses_forgotten = false;
};
double impulse(const Hit& hit, const Mistakes& made) {
  const double factor = made.e_for_one_plus_e ? hit.e : 1.0 + hit.e;
  const double below =
      (made.masses_forgotten ? 0.0 : hit.masses) + (made.turning_forgotten ? 0.0 : hit.turning);
  return (made.sign ? -1.0 : 1.0) * factor * hit.speed / below;
}

std::vector<Failure> failures_with(const Mistakes& made) {
  std::vector<Failure> failures;
  for (const Hit& hit : kHits) {
    failures.push_back(wrong(fmt::format("Impulse.Of{}", hit.speed),
                             fmt::format("{:.12g} N s", impulse(hit, made))));
    failures.back().expected = fmt::format("{:.12g} N s", impulse(hit, {}));
  }
  return failures;
}

std::vector<AuditedSlip> slips_of_the_impulse() {
  return {{"e", "e where (1 + e) belongs", "", failures_with({.e_for_one_plus_e = true})},
          {"masses", "no masses", "", failures_with({.masses_forgotten = true})},
          {"sign", "no minus", "", failures_with({.sign = true})},
          {"turning", "no turning", "", failures_with({.turning_forgotten = true})}};
}

TEST(TwoSlips, InAProductASumAndADenominatorGiveWhatFollowsFromEachAlone) {
  const auto both = [](Together rule, double right, double a, double b, double found) {
    const auto said = [](double number) { return answer_of(fmt::format("{:.12g} N", number)); };
    return is_answer_of_both(rule, said(right), said(a), said(b), said(found));
  };
  for (const Hit& hit : kHits) {
    EXPECT_TRUE(both(Together::kFactors, impulse(hit, {}), impulse(hit, {.sign = true}),
                     impulse(hit, {.e_for_one_plus_e = true}),
                     impulse(hit, {.sign = true, .e_for_one_plus_e = true})));
    const double share = hit.turning / 2;  // of each body: both forgotten leave the masses
    const auto j = [&](double below) { return (1.0 + hit.e) * hit.speed / below; };
    EXPECT_TRUE(both(Together::kTermsBelow, impulse(hit, {}), j(hit.masses + share),
                     j(hit.masses + share), impulse(hit, {.turning_forgotten = true})));
  }
  // w x r forgotten in the velocities of both bodies: 2 + 3 - 4 - 5
  EXPECT_TRUE(both(Together::kTerms, 2.0 + 3 - 4 - 5, 2.0 - 4 - 5, 2.0 + 3 - 4, 2.0 - 4));
  // told in 8 digits, of which a sum loses the last
  EXPECT_TRUE(both(Together::kTerms, 1.2345678, 3.7654322, -2.5308641, 2.9e-7));
  // one of them alone, or none, is no answer of both
  EXPECT_FALSE(both(Together::kFactors, 9, -9, 3, 3));
  EXPECT_FALSE(both(Together::kFactors, 9, -9, 3, -9));
  EXPECT_FALSE(both(Together::kFactors, 9, -9, -9, 9));
  EXPECT_FALSE(both(Together::kFactors, 9, -9, 3, -3.00001));
  // other words are another answer
  EXPECT_FALSE(is_answer_of_both(Together::kFactors, answer_of("9 N s"), answer_of("-9 N s"),
                                 answer_of("3 N s"), answer_of("-3 m/s")));
}

// No test gives the answer of either alone, so neither can be found by its own.
TEST(LikelySlips, TwoInOneExpressionAreNamedTogetherWithTheShareOfEach) {
  const auto found = likely_slips(failures_with({.sign = true, .e_for_one_plus_e = true}), {},
                                  slips_of_the_impulse());
  ASSERT_EQ(names(found), std::vector<std::string>{"e"});
  EXPECT_EQ(found[0].with, "sign");
  EXPECT_EQ(found[0].tests.size(), kCount);
  EXPECT_EQ(found[0].by_both, kCount);
  EXPECT_EQ(found[0].alone[0], kCount);
  EXPECT_EQ(found[0].alone[1], kCount);
  EXPECT_TRUE(found[0].equals.empty());
}

TEST(LikelySlips, OneSlipIsNotTakenForTwo) {
  for (const Mistakes& made :
       {Mistakes{.sign = true}, {.e_for_one_plus_e = true}, {.masses_forgotten = true}}) {
    const auto found = likely_slips(failures_with(made), {}, slips_of_the_impulse());
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].with, "");
    EXPECT_EQ(found[0].same_numbers, kCount);
  }
}

// Of two tests in five it may be chance.
TEST(LikelySlips, TwoThatExplainLessThanHalfAreNotNamedTogether) {
  auto failures = failures_with({.sign = true, .e_for_one_plus_e = true});
  for (std::size_t i = 2; i < kCount; ++i) failures[i].found = fmt::format("{} N s", 10 + i);
  for (const LikelySlip& likely : likely_slips(failures, {}, slips_of_the_impulse()))
    EXPECT_EQ(likely.with, "") << likely.name;
}

ScoredTest scored(const std::string& name, double points, Verdict verdict,
                  const std::string& function, const std::string& story = "") {
  ScoredTest test;
  test.item = {name, points, "basic", name, false};
  test.result.test = name;
  test.result.verdict = verdict;
  test.result.last_call = function;
  test.result.story = story;
  test.score = verdict == Verdict::kRight ? points : 0.0;
  return test;
}

TEST(Causes, EveryTestThatIsNotRightHasOneAndTheCostliestIsFirst) {
  const std::vector<ScoredTest> tests = {
      scored("Impulse.Central", 5, Verdict::kWrong, "collision_impulse", "found: 6 N s"),
      scored("Impulse.Wall", 5, Verdict::kWrong, "collision_impulse", "found: 2 N s"),
      scored("Ray.Hit", 4, Verdict::kCrashed, "intersect_ray_triangle", "SIGSEGV"),
      scored("Ray.Miss", 9, Verdict::kCrashed, "intersect_ray_triangle", "SIGSEGV"),
      scored("Resolve.Both", 3, Verdict::kNotAttempted, "resolve_collision"),
      scored("Force.Torque", 2, Verdict::kRight, "wrench_of_point_force")};
  const auto causes =
      causes_of(tests, slips(), "a1.cpp",
                "double f();\n\ndouble collision_impulse(int a) {\n  return f();\n}");
  ASSERT_EQ(causes.size(), 3u);
  EXPECT_EQ(causes[0].kind, Cause::Kind::kCrash);
  EXPECT_EQ(causes[0].says, "intersect_ray_triangle crashes");
  EXPECT_EQ(points_lost(causes[0], tests), 13.0);
  EXPECT_EQ(causes[1].says, "the (1 + e) is missing");
  EXPECT_EQ(points_lost(causes[1], tests), 10.0);
  EXPECT_EQ(causes[1].places, std::vector<std::string>{"a1.cpp:3"});
  EXPECT_EQ(causes[1].code, std::vector<std::string>{"     3  double collision_impulse(int a) {\n"
                                                     "     4    return f();\n     5  }\n"});
  EXPECT_EQ(causes[2].kind, Cause::Kind::kNotWritten);
}

// e_forgotten explains the first; the second asks the first, the third is of its own.
TEST(Causes, WhatAsksAFailingFunctionStandsUnderItsCause) {
  const std::string source =
      "double collision_impulse(int a) { return a; }\n"
      "double resolve_collision(int a) { return collision_impulse(a); }\n"
      "double wrench_of_point_force(int a) { return a; }\n";
  const std::vector<ScoredTest> tests = {
      scored("Impulse.Central", 5, Verdict::kWrong, "collision_impulse", "found: 6 N s"),
      scored("Resolve.Gap", 3, Verdict::kWrong, "resolve_collision", "found: 17 m/s"),
      scored("Force.Other", 2, Verdict::kWrong, "wrench_of_point_force", "found: 8 N m")};
  const auto causes = causes_of(tests, slips(), "a1.cpp", source);
  ASSERT_EQ(causes.size(), 2u);
  EXPECT_EQ(causes[0].says, "the (1 + e) is missing");
  EXPECT_EQ(causes[0].tests, std::vector<std::string>{"Impulse.Central"});
  EXPECT_EQ(causes[0].following, std::vector<std::string>{"Resolve.Gap"});
  EXPECT_EQ(points_lost(causes[0], tests), 8.0);
  EXPECT_EQ(causes[1].tests, std::vector<std::string>{"Force.Other"});
}

TEST(Causes, TwoMistakesOfOneLineAreSaidInOneCause) {
  std::vector<ScoredTest> tests;
  for (const Failure& failure :
       failures_with({.e_for_one_plus_e = true, .turning_forgotten = true})) {
    tests.push_back(
        scored(failure.test, 2, Verdict::kWrong, "collision_impulse",
               "\n  expected: " + failure.expected + "\n  found:    " + failure.found + "\n"));
  }
  const auto causes = causes_of(tests, slips_of_the_impulse(), "a1.cpp", "");
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].says, "e where (1 + e) belongs");
  EXPECT_EQ(causes[0].and_also, "no turning");
  EXPECT_EQ(causes[0].by_both, kCount);
  EXPECT_EQ(causes[0].alone[0], kCount);
  EXPECT_EQ(causes[0].alone[1], kCount);
}

// The first answer is that of the first mistake; with that mended the second fails the test.
TEST(Causes, ATestThatAnotherCauseFailsTooNeedsBoth) {
  std::vector<AuditedSlip> known = {
      {"one",
       "one thing",
       "",
       {{"T.Both", Verdict::kWrong, "1 m", "f"}, {"T.One", Verdict::kWrong, "2 m", "f"}}},
      {"two",
       "another thing",
       "",
       {{"T.Both", Verdict::kWrong, "5 m", "g"}, {"T.Two", Verdict::kWrong, "6 m", "g"}}}};
  const std::vector<ScoredTest> tests = {scored("T.Both", 4, Verdict::kWrong, "f", "found: 1 m"),
                                         scored("T.One", 4, Verdict::kWrong, "f", "found: 2 m"),
                                         scored("T.Two", 1, Verdict::kWrong, "g", "found: 6 m")};
  const auto causes = causes_of(tests, known, "a1.cpp", "");
  ASSERT_EQ(causes.size(), 2u);
  EXPECT_EQ(causes[0].tests, (std::vector<std::string>{"T.Both", "T.One"}));
  EXPECT_EQ(causes[0].also_needed, (std::vector<std::pair<std::size_t, std::size_t>>{{1, 1}}));
  EXPECT_TRUE(causes[1].also_needed.empty());
}

// One answer that several mistakes give explains no test, but that of a mistake with other evidence
// is named: here f's mistake shows in g, which uses f's answer.
TEST(Causes, AnAnswerThatTheMistakeOfAnotherCauseGivesMayFollowFromIt) {
  std::vector<AuditedSlip> known = {
      {"of_f",
       "a factor of f",
       "f",
       {{"T.One", Verdict::kWrong, "2 m", "f"}, {"T.Uses", Verdict::kWrong, "1 m", "g"}}}};
  for (const char* name : {"a", "b", "c", "d", "e"})
    known.push_back(
        {name,
         name,
         "h",
         {{"T.Uses", Verdict::kWrong, "1 m", "g"}, {"T.Right", Verdict::kWrong, "1 m", "g"}}});
  const std::vector<ScoredTest> tests = {scored("T.One", 4, Verdict::kWrong, "f", "found: 2 m"),
                                         scored("T.Uses", 2, Verdict::kWrong, "g", "found: 1 m"),
                                         scored("T.Else", 1, Verdict::kWrong, "g", "found: 9 m"),
                                         scored("T.Right", 1, Verdict::kRight, "g")};
  const auto causes = causes_of(tests, known, "a1.cpp", "");
  ASSERT_EQ(causes.size(), 2u);
  EXPECT_EQ(causes[1].kind, Cause::Kind::kUnknown);
  EXPECT_EQ(causes[1].tests, (std::vector<std::string>{"T.Uses", "T.Else"}));
  EXPECT_EQ(causes[1].may_follow, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 1}}));
  EXPECT_TRUE(causes[0].may_follow.empty());
}

TEST(Causes, TestsThatWereNotRunBelongToWhatUsedTheTimeWhichIsFirst) {
  std::vector<ScoredTest> tests = {
      scored("Force.Torque", 1, Verdict::kOutOfResources, "linear_acceleration", "no answer"),
      scored("Ray.Hit", 4, Verdict::kWrong, "intersect_ray_triangle", "found: a miss"),
      scored("Resolve.Both", 2, Verdict::kOutOfResources, "", "not run: used up")};
  tests[0].result.timed_out_s = 2.0;
  tests[2].result.not_run = true;
  const auto causes = causes_of(tests, {}, "a1.cpp", "");
  ASSERT_EQ(causes.size(), 2u);
  EXPECT_EQ(causes[0].says, "linear_acceleration takes too much time or memory");
  EXPECT_EQ(causes[0].tests, std::vector<std::string>{"Force.Torque"});
  EXPECT_EQ(causes[0].not_run, std::vector<std::string>{"Resolve.Both"});
  EXPECT_EQ(points_lost(causes[0], tests), 3.0);
}

TEST(Causes, TheLineOfACrashIsMarked) {
  std::string source;
  for (int i = 1; i <= 9; ++i) source += "line " + std::to_string(i) + "\n";
  EXPECT_EQ(lines_around(source, 2),
            "     1  line 1\n->   2  line 2\n     3  line 3\n     4  line 4\n     5  line 5\n");
  EXPECT_EQ(lines_around(source, 9).substr(0, 15), "     6  line 6\n");
  // a bracket in a comment ends nothing, and a function without an end ends with the file
  EXPECT_EQ(lines_of_function("void f() {  // }\n  g();\n}\nint x;\n", 1),
            "     1  void f() {  // }\n     2    g();\n     3  }\n");
  EXPECT_EQ(lines_of_function("void f() {\n", 1), "     1  void f() {\n");
  EXPECT_EQ(lines_around("a;\r\n", 1), "->   1  a;\n");
  // a line of a megabyte is not a page of one
  EXPECT_LT(lines_around(std::string(1 << 20, 'x'), 1).size(), 200u);
}

TEST(Causes, ADefinitionIsNeitherACallNorADeclarationNorAComment) {
  const std::string source =
      "// rk4_step(f) { in a comment }\n"
      "double rk4_step(double t);\n"
      "double my_rk4_step(double t) { return rk4_step(t); }\n"
      "double\nrk4_step(double t) noexcept {\n  return t;\n}\n";
  EXPECT_EQ(line_of_definition(source, "rk4_step"), 5);
  EXPECT_EQ(line_of_definition(source, "rk5_step"), 0);
}

}  // namespace
}  // namespace tumble::grading
