// What a failing test tells (tests/support/story.h).
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/story.h"

namespace tumble::testing {
namespace {

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The message of the one failure that a comparison makes.
template <class Check>
std::string told_by(const Check& check) {
  ::testing::TestPartResultArray parts;
  {
    const ::testing::ScopedFakeTestPartResultReporter reporter(
        ::testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &parts);
    check();
  }
  return parts.size() == 1 ? parts.GetTestPartResult(0).message() : "";
}

TEST(Told, OnlyAnAnswerThatShowsTheMistakeIsCalledLikely) {
  const std::string shown_one = tell({.slip = shown("the sign")}, "1", "-1", "m"),
                    other = tell({.slip = "v' = v + J / m"}, "1", "7", "m");
  EXPECT_TRUE(holds(shown_one, "\n  likely:   the sign")) << shown_one;
  EXPECT_TRUE(holds(other, "\n  look at:  v' = v + J / m")) << other;
  EXPECT_FALSE(holds(other, "likely")) << other;
}

TEST(Told, WhatTheAnswerShowsGivesWayOnlyToWhatItShows) {
  const Story story{.slip = shown("the sign")};
  EXPECT_EQ(with_slip(story, "float, perhaps").slip.words, "the sign");
  EXPECT_EQ(with_slip(story, shown(kKept)).slip.words, kKept);
  EXPECT_EQ(with_slip({.slip = "the law"}, "no number").slip.words, "no number");
}

// Digits that say nothing are read all the same: a wrong answer is told in eight, with more only
// where its error is smaller, and an error in three.
TEST(Told, NumbersHaveTheDigitsThatSayHowWrongTheyAre) {
  const double pi = std::acos(-1.0);
  const auto scalar = [&](double found, double allowed) {
    return told_by([&] { expect_near(found, pi, allowed, "m", {}); });
  };
  EXPECT_TRUE(holds(scalar(2 * pi, 1e-15),
                    "expected: 3.1415927 m\n  found:    6.2831853 m\n"
                    "  off by:   3.14 m (allowed"))
      << scalar(2 * pi, 1e-15);
  EXPECT_TRUE(holds(scalar(pi + 1e-8, 1e-15), "found:    3.14159266359 m")) << scalar(pi + 1e-8, 0);
  EXPECT_TRUE(holds(scalar(1e5 * pi, 1), "found:    314159.27 m")) << scalar(1e5 * pi, 1);
  EXPECT_TRUE(holds(scalar(std::nan(""), 1e-15), "expected: 3.1415927 m"));
  const std::string vector = told_by(
      [&] { expect_near(Eigen::Vector2d(pi, 1.0 / 3), Eigen::Vector2d(pi, 0), 1e-12, "N", {}); });
  EXPECT_TRUE(holds(vector, "found:    (3.1415927, 0.33333333) N")) << vector;
}

TEST(Told, NothingIsSubtractedFromWhatIsNoNumber) {
  const double nan = std::copysign(std::numeric_limits<double>::quiet_NaN(), -1.0);
  const std::string told = told_by([&] { expect_near(nan, 1.0, 0.0, "s", {}); }),
                    of_vector = told_by([&] {
                      expect_near(Eigen::Vector2d(nan, 1), Eigen::Vector2d(0, 1), 0.0, "s", {});
                    });
  for (const std::string& text : {told, of_vector}) {
    EXPECT_FALSE(holds(text, "off by")) << text;
    EXPECT_FALSE(holds(text, "-nan")) << text;
    EXPECT_TRUE(holds(text, "nan")) << text;
  }
  EXPECT_TRUE(
      holds(told_by([] { expect_near(1.5, 1.0, 0.0, "s", {}); }), "off by:   0.5 s (allowed 0 s)"));
  EXPECT_TRUE(holds(told_by([] { expect_near(2.0, 1.0, 0.0, "calls of the gap", {}); }),
                    "off by:   1 (allowed 0)"));
  EXPECT_TRUE(holds(told_by([] { expect_near(1.5, 1.0, 0.0, "N (sum)", {}); }),
                    "off by:   0.5 N (allowed 0 N)"));
  EXPECT_TRUE(holds(told_by([] { expect_near(1.5, 1.0, 0.0, "(unit)", {}); }),
                    "off by:   0.5 (allowed 0)"));
  EXPECT_TRUE(
      holds(told_by([] { expect_near(1.5, 1.0, 0.0, "", {}); }), "off by:   0.5 (allowed 0)"));
  EXPECT_TRUE(holds(
      told_by([] { expect_near(Eigen::Vector2d(0, 2), Eigen::Vector2d(0, 1), 0.5, "m", {}); }),
      "off by:   1 m (allowed 0.5 m)"));
}

// An error of float's size is what many methods leave: only bits of float show float.
TEST(Told, FloatIsShownByItsBitsAndNotByTheSizeOfAnError) {
  const Eigen::Vector2d expected(1.0 / 3, 2.0 / 3), near = expected * (1 + 2e-7),
                                                    rounded = expected.cast<float>().cast<double>();
  const Mistake by_size = slip_in_the_digits(numbers_of(near), numbers_of(expected), 1e-15, {}),
                by_bits = slip_in_the_digits(numbers_of(rounded), numbers_of(expected), 1e-15, {});
  EXPECT_FALSE(by_size.is_shown) << by_size.words;
  EXPECT_TRUE(holds(by_size.words, "one way to get such an answer: float")) << by_size.words;
  EXPECT_TRUE(by_bits.is_shown);
  EXPECT_EQ(by_bits.words, kFloat);
  EXPECT_TRUE(slip_in_the_digits(numbers_of(near), numbers_of(expected), 1e-15, {.iterates = true})
                  .empty());
}

TEST(Told, AScaleIsAPowerOfTwoOrThreeDigits) {
  EXPECT_EQ(show_scale(0x1p-60), "2^-60");
  EXPECT_EQ(show_scale(0x1p60), "2^60");
  EXPECT_EQ(show_scale(4.0), "4");
  EXPECT_EQ(show_scale(5e-8 / 3), "1.67e-08");
}

}  // namespace
}  // namespace tumble::testing
