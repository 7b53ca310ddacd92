// Sentences and numbers as a reader has them.
#include <gtest/gtest.h>

#include "framework/core/text.h"

namespace tumble {
namespace {

TEST(Sentence, HasACapitalLetterAndAFullStop) {
  EXPECT_EQ(sentence("both impulses act at the same point: round-off only"),
            "Both impulses act at the same point: round-off only.");
  EXPECT_EQ(sentence("a ball never enters another."), "A ball never enters another.");
  EXPECT_EQ(sentence("Is it so?"), "Is it so?");
  EXPECT_EQ(sentence("statics, by hand"), "Statics, by hand.");
  EXPECT_EQ(sentence("round-off of one impulse"), "Round-off of one impulse.");
  EXPECT_EQ(sentence("body's own"), "Body's own.");
  EXPECT_EQ(sentence(""), "");
}

TEST(Sentence, LeavesSymbolsAndNamesAsTheyAre) {
  EXPECT_EQ(sentence("e = 1, and rods do no work"), "Here e = 1, and rods do no work.");
  EXPECT_EQ(sentence("a t^2 / 2: a parabola"), "Here a t^2 / 2: a parabola.");
  EXPECT_EQ(sentence("a = g"), "Here a = g.");
  EXPECT_EQ(sentence("mu = tan 25 deg"), "Here mu = tan 25 deg.");
  EXPECT_EQ(sentence("t/R is small"), "Here t/R is small.");
  EXPECT_EQ(sentence("w' is 0"), "Here w' is 0.");
  EXPECT_EQ(sentence("rk4_step is called"), "Here rk4_step is called.");
  EXPECT_EQ(sentence("1e-5 J/kg is a speed of 4 mm/s"), "1e-5 J/kg is a speed of 4 mm/s.");
}

TEST(Sentence, TwoHaveABlankBetweenThem) {
  EXPECT_EQ(sentences("at t = 0.933 s", "round-off only"), "At t = 0.933 s. Round-off only.");
  EXPECT_EQ(sentences("", "round-off only"), "Round-off only.");
  EXPECT_EQ(sentences("at t = 1 s", ""), "At t = 1 s.");
}

TEST(ThreeDigits, HaveNoZerosThatSayNothing) {
  EXPECT_EQ(three_digits(0.3234), "0.323");
  EXPECT_EQ(three_digits(1e-9), "1e-9");
  EXPECT_EQ(three_digits(-2.5e-10), "-2.5e-10");
  EXPECT_EQ(three_digits(3e8), "3e8");
  EXPECT_EQ(three_digits(-0.0), "0");
}

// 0.08 m is plain, 8.0e-02 m is not.
TEST(FewDigits, HaveAPowerOfTenOnlyWhereTheyWouldBeLong) {
  EXPECT_EQ(few_digits(0.08), "0.08");
  EXPECT_EQ(few_digits(0.885), "0.89");
  EXPECT_EQ(few_digits(123.0), "120");
  EXPECT_EQ(few_digits(6.2e-5), "6.2e-5");
  EXPECT_EQ(few_digits(1e-7, 1), "1e-7");
  EXPECT_EQ(few_digits(2.5e6), "2.5e6");
}

TEST(StepInWords, IsAPartOfASecondWhereItIsOne) {
  EXPECT_EQ(step_in_words(0.016666666666666666), "1/60");
  EXPECT_EQ(step_in_words(0.0166667), "0.0167");  // rounded elsewhere: not that step
  EXPECT_EQ(step_in_words(0.125), "1/8");
  EXPECT_EQ(step_in_words(1e-7), "1e-7");
  EXPECT_EQ(step_in_words(0.3), "0.3");
  EXPECT_EQ(step_in_words(2.0), "2");
  EXPECT_EQ(step_in_words(0.0), "0");  // of an engine without steps
}

TEST(Capitalised, IsAWordAndNoNameOfTheProgram) {
  EXPECT_EQ(capitalised("symplectic Euler, order 1"), "Symplectic Euler, order 1");
  EXPECT_EQ(capitalised("midpoint"), "Midpoint");
  for (const char* name : {"ca, RK4", "rk4_step is called", "RK4", ""})
    EXPECT_EQ(capitalised(name), name);
}

}  // namespace
}  // namespace tumble
