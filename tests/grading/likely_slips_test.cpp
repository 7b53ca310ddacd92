// Failing tests matched to slips, by their names and by the answers that came.
#include <gtest/gtest.h>

#include "framework/grading/grades/causes.h"
#include "framework/grading/grades/likely_slips.h"

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
