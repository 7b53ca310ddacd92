// Which failing function is to be mended first, from the verdicts and the text of a submission.
#include <gtest/gtest.h>

#include <sstream>

#include "framework/grading/verdicts/mend_order.h"
#include "framework/grading/verdicts/own_functions.h"
#include "framework/grading/verdicts/verdict_table.h"

namespace tumble::grading {
namespace {

constexpr const char* kSource = R"(// helper(f) { in a comment }
double helper(double x) { return x; }
double velocity(double x) { return helper(x); }
double impulse(double x) {
  if (x < 0) { return 0; }
  return -2 * velocity(x);
}
double resolve(double x) { return apply(impulse(x)); }
double apart(double x) { return x < 1 ? x : apart(x / 2); }
)";

TestResult result(const std::string& test, Verdict verdict, const std::string& function,
                  const std::string& story = "") {
  TestResult one;
  one.test = test;
  one.verdict = verdict;
  one.last_call = function;
  one.story = story;
  return one;
}

std::vector<TestResult> velocity_is_wrong() {
  return {
      result("V.One", Verdict::kWrong, "velocity", "\n  likely:   the sign: n . u\n  read:     x"),
      result("V.Two", Verdict::kRight, "velocity"),
      result("J.One", Verdict::kWrong, "impulse", "\n  look at:  the law"),
      result("R.One", Verdict::kWrong, "resolve"), result("A.One", Verdict::kWrong, "apart")};
}

TEST(OwnFunctions, AreAskedDirectlyOrThroughOthers) {
  const auto asked = functions_asked(kSource, {"velocity", "impulse", "resolve", "apart", "none"});
  EXPECT_EQ(asked.at("resolve"), (std::set<std::string>{"impulse", "velocity", "helper"}));
  EXPECT_EQ(asked.at("velocity"), std::set<std::string>{"helper"});
  EXPECT_EQ(asked.at("apart"), std::set<std::string>{}) << "itself does not count";
  EXPECT_FALSE(asked.contains("none"));
  EXPECT_EQ(with_its_line(kSource, "impulse"), "impulse (which begins in line 4)");
  EXPECT_EQ(with_its_line(kSource, "none"), "none");
}

TEST(MendOrder, WhatAsksAFailingFunctionFollowsFromIt) {
  const auto follows = what_follows(velocity_is_wrong(), kSource);
  EXPECT_EQ(follows,
            (std::map<std::string, std::string>{{"impulse", "velocity"}, {"resolve", "velocity"}}));
}

TEST(MendOrder, AFunctionThatFailsFewOfItsOwnTestsExplainsNoOther) {
  std::vector<TestResult> results = velocity_is_wrong();
  for (int i = 0; i < 3; ++i) results.push_back(result("V.More", Verdict::kRight, "velocity"));
  EXPECT_EQ(what_follows(results, kSource),
            (std::map<std::string, std::string>{{"resolve", "impulse"}}));
}

TEST(MendOrder, FunctionsThatAskEachOtherFollowFromNeither) {
  const std::string both = "int f(int x) { return g(x); }\nint g(int x) { return f(x); }\n";
  EXPECT_TRUE(
      what_follows({result("F.A", Verdict::kWrong, "f"), result("G.A", Verdict::kWrong, "g")}, both)
          .empty());
}

TEST(MendOrder, OneHeadingHoldsAllThatOneFunctionExplains) {
  const auto headings = headings_of(velocity_is_wrong(), kSource);
  EXPECT_EQ(headings[0],
            "velocity (which begins in line 3): mend this first; other functions ask it, and "
            "probably fail for it; likely: the sign");
  EXPECT_EQ(headings[1], "");
  EXPECT_EQ(headings[2], headings[0]);
  EXPECT_EQ(headings[3], headings[0]);
  EXPECT_EQ(headings[4], "wrong in apart (which begins in line 9)");
}

std::vector<TestResult> a_loop_in_velocity() {
  std::vector<TestResult> results = {
      result("V.One", Verdict::kOutOfResources, "velocity", "no answer within 2 s, in velocity"),
      result("J.One", Verdict::kOutOfResources, "impulse", "impulse needed more memory"),
      result("R.One", Verdict::kOutOfResources, "", "not run: the time is used up"),
      result("R.Two", Verdict::kOutOfResources, "", "not run: the time is used up")};
  results[0].timed_out_s = 2.0;
  results[2].not_run = results[3].not_run = true;
  return results;
}

TEST(MendOrder, TestsThatWereNotRunBelongToTheFunctionThatUsedTheTime) {
  std::vector<TestResult> results = a_loop_in_velocity();
  EXPECT_EQ(what_used_the_time(results), "velocity");
  const auto headings = headings_of(results, kSource);
  EXPECT_EQ(headings[0],
            "out of time or memory in velocity (which begins in line 3): mend this first");
  EXPECT_EQ(headings[2], headings[0]);
  results.resize(2);
  EXPECT_EQ(what_used_the_time(results), "") << "all tests have run";
}

TEST(MendOrder, ALineThatIsKnownIsTheOnlyOne) {
  const TestResult crash =
      result("A.One", Verdict::kCrashed, "apart", "SIGSEGV: a fault, in apart, mine.cpp:12");
  EXPECT_EQ(exact_place_of(crash), "mine.cpp:12");
  EXPECT_EQ(headings_of({crash}, kSource)[0], "crashed in apart, mine.cpp:12");
  EXPECT_EQ(exact_place_of(result("A.One", Verdict::kCrashed, "apart", "SIGSEGV, in apart")), "");
}

// Two functions that cost the same, one of them by a slip that costs more elsewhere; a third that
// stories name in two ways.
std::vector<TestResult> slips() {
  return {result("G.KeepsNothingBetweenCalls", Verdict::kWrong, "apart", "\n  look at:  apart"),
          result("A.One", Verdict::kWrong, "apart", "\n  likely:   a factor\n"),
          result("A.Two", Verdict::kWrong, "apart", "\n  likely:   the frame\n"),
          result("A.Three", Verdict::kWrong, "apart", "\n  likely:   the frame\n"),
          result("H.One", Verdict::kWrong, "spin", "\n  look at:  it"),
          result("W.One", Verdict::kNotAttempted, "write", "write is to be written"),
          result("V.One", Verdict::kWrong, "drop", "\n  likely:   the sign\n"),
          result("R.One", Verdict::kRight, "resolve")};
}

TEST(MendOrder, AHeadingNamesTheSlipsThatItsStoriesNameTheCommonOneFirst) {
  const auto headings = headings_of(slips(), kSource);
  EXPECT_EQ(headings[0],
            "wrong in apart (which begins in line 9); likely: the frame; or: a factor");
  for (const int i : {1, 2, 3}) EXPECT_EQ(headings[static_cast<std::size_t>(i)], headings[0]);
  EXPECT_EQ(headings[4], "wrong in spin");
}

TEST(MendOrder, TheStoryThatNamesTheSlipComesFirstAndTheOneOfTwoCallsLast) {
  const std::vector<TestResult> results = slips();
  const auto groups =
      in_order_of_mending(results, headings_of(results, kSource), {9, 0.1, 0.1, 0.1, 2, 99, 2, 99});
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_EQ(groups[0].tests, (std::vector<std::size_t>{1, 2, 3, 0}));
  EXPECT_NE(groups[1].heading.find("drop"), std::string::npos) << "of equal ones the named slip";
  EXPECT_NE(groups[2].heading.find("spin"), std::string::npos);
  EXPECT_FALSE(groups[3].is_attempted) << "last what is not written";
}

TEST(MendOrder, OneSlipUnderTwoHeadingsWeighsWhatBothCost) {
  std::vector<TestResult> results = slips();
  results[4].story = "\n  likely:   the sign\n";
  results[0].last_call = results[1].last_call = "push";
  const auto groups =
      in_order_of_mending(results, headings_of(results, kSource), {1, 1, 1, 1, 1.5, 0, 1.5, 0});
  ASSERT_GE(groups.size(), 3u);
  EXPECT_NE(groups[0].heading.find("the sign"), std::string::npos) << groups[0].heading;
  EXPECT_NE(groups[1].heading.find("the sign"), std::string::npos) << groups[1].heading;
}

TEST(VerdictTable, TestsOfOneGroupAreOneLineWhereTheyAreMany) {
  std::vector<TestResult> results;
  for (int i = 0; i < 14; ++i)
    results.push_back(result((i < 10 ? "RayTriangle.T" : "Rk4Step.T") + std::to_string(i),
                             i == 12 ? Verdict::kWrong : Verdict::kRight, "apart"));
  std::ostringstream folded, whole;
  print_verdicts(folded, results, {}, {});
  EXPECT_NE(folded.str().find("\n  ok   10 of 10  Ray triangle\n        3 of  4  Rk4 step      "
                              "1 wrong\n"),
            std::string::npos)
      << folded.str();
  EXPECT_EQ(folded.str().find("RayTriangle.T3"), std::string::npos) << folded.str();
  print_verdicts(whole, results, {}, {.all = true});
  EXPECT_NE(whole.str().find("RayTriangle.T3"), std::string::npos) << whole.str();
}

TEST(VerdictTable, LinesAreBrokenBehindTheirLabels) {
  std::ostringstream out;
  print_verdicts(
      out,
      {result(
          "A.One", Verdict::kWrong, "apart",
          "\n  scene:    a ball that falls on a plane and is thrown back by it, several times in "
          "a row\n  likely:   the sign")},
      {}, {.columns = 60, .source = kSource});
  EXPECT_NE(out.str().find("    scene:    a ball that falls on a plane and is thrown\n"
                           "              back by it, several times in a row\n    likely:"),
            std::string::npos)
      << out.str();
}

TEST(VerdictTable, SaysWhatWasNotRunAndWhatToMendFirst) {
  std::ostringstream out;
  print_verdicts(out, a_loop_in_velocity(), {}, {.source = kSource});
  const std::string text = out.str();
  EXPECT_NE(text.find("4 tests: 2 out of time or memory, 2 not run"), std::string::npos) << text;
  EXPECT_NE(text.find("mend first\n    out of time or memory in velocity (which begins in line 3): "
                      "mend this first\n        (4 tests)\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("velocity begins in line 3\n"), std::string::npos) << text;
  EXPECT_NE(text.find("probably follows from velocity (which begins in line 3)"), std::string::npos)
      << text;
  const std::string once = "not run: the time is used up";
  EXPECT_EQ(text.find(once), text.rfind(once)) << text;
}

}  // namespace
}  // namespace tumble::grading
