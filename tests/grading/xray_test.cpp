// An equation with the numbers of a call, and the term that is wrong.
#include <gtest/gtest.h>

#include "framework/grading/verdicts/xray.h"

namespace tumble::grading {
namespace {

// j = -(1 + e) u / k with u = -3, e = 1/2, k = 1/2: 9 N s.
Xray impulse(double found) {
  Xray x{"j = -(1 + e) u / k", {}, "j", "N s", numbers(9.0), numbers(found), {}};
  x.terms = {{"u", numbers(-3.0), "m/s"}, {"1 + e", numbers(1.5), ""}, {"k", numbers(0.5), "1/kg"}};
  x.variants = {{1, "with e for 1 + e", numbers(3.0)}, {1, "with 1 for 1 + e", numbers(6.0)}};
  return x;
}

TEST(Xray, MarksTheTermWhoseVariantGivesTheAnswerThatCame) {
  const std::string words = xray_in_words(impulse(6.0));
  EXPECT_NE(
      words.find("1 + e                     1.5   <- your answer comes out with 1 for 1 + e\n"),
      std::string::npos)
      << words;
  EXPECT_NE(words.find("j, expected               9 N s\n"), std::string::npos) << words;
  EXPECT_TRUE(words.ends_with("j, found                  6 N s")) << words;
  EXPECT_EQ(words.find("<-"), words.rfind("<-"));
}

// F x r and (x - p) x F are the same torque: either mistake may be the one that was made.
TEST(Xray, NamesEveryVariantThatGivesTheAnswerThatCame) {
  Xray x = impulse(6.0);
  x.variants.push_back({1, "with 2 e", numbers(6.0)});
  EXPECT_NE(xray_in_words(x).find("1.5   <- your answer comes out with 1 for 1 + e, or with 2 e\n"),
            std::string::npos)
      << xray_in_words(x);
  x.variants.back() = {2, "with 0.75 for k", numbers(6.0)};
  EXPECT_NE(xray_in_words(x).find("0.5 1/kg   <- or it comes out with 0.75 for k\n"),
            std::string::npos)
      << xray_in_words(x);
}

TEST(Xray, HasAsManyDigitsAsTellTheAnswersApart) {
  const std::string words = xray_in_words(impulse(9.0 * (1 + 6e-8)));
  EXPECT_NE(words.find("  9 N s\n            j, found                  9.00000054 N s"),
            std::string::npos)
      << words;
  Xray part = impulse(9.0 * (1 + 6e-8));
  part.terms[0].value = part.terms[0].found = numbers(1.0 / 3.0);  // a right one has six
  part.terms[2].found = numbers(0.5 * (1 + 6e-8));
  const std::string of_part = xray_in_words(part);
  EXPECT_NE(of_part.find(" 0.333333 m/s\n"), std::string::npos) << of_part;
  EXPECT_NE(of_part.find(
                "0.5 1/kg   <- the first line that is seen to be wrong: yours is 0.50000003 1/kg"),
            std::string::npos)
      << of_part;
}

// Parts of the answer that are right, and nothing unseen behind them, leave one term: the next.
TEST(Xray, NamesWhatIsNotSeenBeforeTheFirstWrongPart) {
  Xray part = impulse(7.0);
  part.terms[2].found = numbers(0.25);
  EXPECT_NE(xray_in_words(part).find("yours is 0.25 1/kg; the mistake may stand before it, in what "
                                     "nobody sees: u, 1 + e\n"),
            std::string::npos)
      << xray_in_words(part);
  part.terms[0].found = numbers(-3.0);
  EXPECT_NE(xray_in_words(part).find("in what nobody sees: 1 + e\n"), std::string::npos);
  part.terms[1].found = numbers(1.5);
  EXPECT_NE(xray_in_words(part).find("<- the first wrong line: yours is 0.25 1/kg\n"),
            std::string::npos);
}

// A formula in a form of its own, with a term wrong that no variant has: nothing can be marked.
TEST(Xray, SaysThatTheTermCannotBeReadWhereNoVariantFits) {
  const std::string words = xray_in_words(impulse(7.0));
  EXPECT_NE(words.find("7 N s   <- which line is wrong cannot be read from "
                       "this answer: no frequent mistake in one line alone gives it"),
            std::string::npos)
      << words;
  EXPECT_EQ(words.find("<-"), words.rfind("<-")) << words;
  Xray seen = impulse(7.0);
  seen.terms[1].found = numbers(1.5);
  EXPECT_NE(xray_in_words(seen).find("7 N s   <- every line that is seen is right, to 1 + e: "),
            std::string::npos)
      << xray_in_words(seen);
  EXPECT_EQ(xray_in_words(impulse(7.0), false).find("<-"), std::string::npos);  // no answer came
}

// A step that takes a slope at the wrong place adds up rightly what it got there.
TEST(Xray, WhatWasAskedMayBeWrongWhereTheAnswerIsRight) {
  Xray x = impulse(9.0);
  x.terms[1].found = numbers(1.0);
  EXPECT_TRUE(is_answered_rightly(x)) << "a part of the answer, which is right";
  x.terms[1].is_asked = true;
  EXPECT_FALSE(is_answered_rightly(x));
  x.variants = {{1, "with 1, which is 2 e, here", numbers(9.0)}};
  const std::string words = xray_in_words(x);
  EXPECT_NE(words.find("<- your answer comes out with 1, which is 2 e, here\n"), std::string::npos)
      << words;
  EXPECT_NE(words.find("9 N s found, as these lines give"), std::string::npos) << words;
  x.terms[1].found = numbers(1.5);
  EXPECT_TRUE(is_answered_rightly(x));
}

TEST(Xray, LongAnswersStandOneBelowTheOtherAndSomeHaveWords) {
  Xray x{"y = x", {}, "y", "m", numbers(Vector3d(0, -0.75, 1)), numbers(Vector3d(0, 0.25, -10)),
         {}};
  EXPECT_NE(xray_in_words(x).find("y, expected               (0, -0.75,   1) m\n"
                                  "            y, found                  (0,  0.25, -10) m"),
            std::string::npos)
      << xray_in_words(x);
  x.words = [](const VectorXd& y) { return y[2] < 0.0 ? std::string("no hit") : ""; };
  EXPECT_NE(xray_in_words(x).find("y, expected               (0, -0.75, 1) m\n"
                                  "            y, found                  no hit"),
            std::string::npos)
      << xray_in_words(x);
}

TEST(Xray, ARightAnswerIsNotShown) {
  EXPECT_EQ(xray_in_words(impulse(9.0 * (1 + 1e-14))), "");
  EXPECT_FALSE(is_answered_rightly(impulse(std::numeric_limits<double>::quiet_NaN())));
}

std::optional<Xray> doubled(const double& found, const double& x, const Vector3d&) {
  return Xray{"y = 2 x", {{"x", numbers(x)}}, "y", "", numbers(2 * x), numbers(found), {}};
}

TEST(Xray, ReadsTheLastCallAsItTravelled) {
  ASSERT_TRUE(add_xray_of("doubled", doubled));
  modules::Writer arguments, answer;
  arguments.value(4.0);
  arguments.value(Vector3d(1, 2, 3));
  answer.value(9.0);
  last_call() = {"doubled", arguments.bytes, answer.bytes};
  EXPECT_NE(xray_of_last_call().find("y, found                  9"), std::string::npos);
  last_call().answer = {};  // it crashed
  EXPECT_NE(xray_of_last_call().find("y, found                  no answer"), std::string::npos);
  last_call().arguments.resize(3);  // cut short
  EXPECT_EQ(xray_of_last_call(), "");
  last_call() = {"unknown", {}, {}};
  EXPECT_EQ(xray_of_last_call(), "");
}

// A test that asks more of a function before it tells what is wrong.
TEST(Xray, GoesBackToTheCallThatWasAnsweredWrongly) {
  ASSERT_TRUE(add_xray_of("doubled", doubled));
  const auto call = [](double x, double found) {
    modules::Writer arguments, answer;
    arguments.value(x);
    arguments.value(Vector3d(1, 2, 3));
    answer.value(found);
    begin_call_to_show();
    last_call() = {"doubled", arguments.bytes, answer.bytes};
  };
  call(4.0, 9.0);
  call(3.0, 7.0);
  call(1.0, 2.0);
  call(2.0, 4.0);
  EXPECT_NE(xray_of_last_call().find("y, found                  9"), std::string::npos);
  // two wrong ones: that of which the story tells
  call(6.0, 13.0);
  EXPECT_NE(xray_of_last_call("\n  found:    9 m").find("y, found                  9"),
            std::string::npos);
  EXPECT_NE(xray_of_last_call("\n  found:    (13, 14) m").find("y, found                  13"),
            std::string::npos);
  EXPECT_NE(xray_of_last_call("\n  found:    nothing").find("y, found                  13"),
            std::string::npos);
  EXPECT_EQ(xray_of_last_call("\n  found:    9 m").find("one call of this test"),
            std::string::npos);
  EXPECT_NE(
      xray_of_last_call("\n  found:    99 m").find("x-ray:    one call of this test: y = 2 x"),
      std::string::npos);
  call(5.0, 11.0);
  EXPECT_NE(xray_of_last_call().find("y, found                  11"), std::string::npos);
  begin_call_to_show();
  last_call().function = "another";
  last_call().answer = {1};
  EXPECT_EQ(xray_of_last_call(), "") << "it is of no other function";
}

}  // namespace
}  // namespace tumble::grading
