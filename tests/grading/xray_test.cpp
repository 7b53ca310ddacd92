// An equation with the numbers of a call, and the term that is wrong.
#include <gtest/gtest.h>

#include "framework/grading/verdicts/xray.h"

namespace tumble::grading {
namespace {

// j = -(1 + e) u / k with u = -3, e = 1/2, k = 1/2: 9 N s.
Xray impulse(double found) {
  Xray x{"j = -(1 + e) u / k", {}, "j", "N s", numbers(9.0), numbers(found), {}};
  x.terms = {{"u", numbers(-3.0), "m/s"}, {"1 + e", numbers(1.5), ""}, {"k", numbers(0.5), "1/kg"}};
  x.variants = {{1, "e", numbers(3.0)}, {1, "1", numbers(6.0)}};
  return x;
}

TEST(Xray, MarksTheTermWhoseVariantGivesTheAnswerThatCame) {
  const std::string words = xray_in_words(impulse(6.0));
  EXPECT_NE(
      words.find(
          "1 + e                     1.5   <- what was found comes out with 1 in its place\n"),
      std::string::npos)
      << words;
  EXPECT_NE(words.find("9 N s expected, 6 N s found"), std::string::npos) << words;
  EXPECT_EQ(words.find("<-"), words.rfind("<-"));
}

TEST(Xray, MarksNothingWhereNoVariantFits) {
  const std::string words = xray_in_words(impulse(7.0));
  EXPECT_NE(words.find("x-ray:"), std::string::npos);
  EXPECT_EQ(words.find("<-"), std::string::npos) << words;
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
  EXPECT_NE(xray_of_last_call().find("8 expected, 9 found"), std::string::npos);
  last_call().answer = {};  // it crashed
  EXPECT_NE(xray_of_last_call().find("8 expected, no answer came"), std::string::npos);
  last_call().arguments.resize(3);  // cut short
  EXPECT_EQ(xray_of_last_call(), "");
  last_call() = {"unknown", {}, {}};
  EXPECT_EQ(xray_of_last_call(), "");
}

}  // namespace
}  // namespace tumble::grading
