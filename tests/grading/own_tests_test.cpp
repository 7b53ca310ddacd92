// The rule for points of a student's own tests, on runs that are given.
#include <gtest/gtest.h>

#include "framework/grading/grades/own_tests.h"

namespace tumble::grading {
namespace {

const OwnTestsRule kFourSlips{4.0, 1.0, {"a", "b", "c", "d"}};

using Failed = std::vector<std::string>;

TriedModule slip(int number, const Failed& first, const Failed& second) {
  return {"slip " + std::to_string(number), "secret", false, {first, second}};
}
TriedModule right(const Failed& first, const Failed& second) {
  return {"right solution 1", "reference", true, {first, second}};
}

TEST(OwnTests, EachSlipCaughtEarnsItsShare) {
  const OwnTestsGrade grade =
      graded_own_tests(kFourSlips, {"S.A", "S.B"},
                       {slip(1, {"S.A"}, {"S.A"}), slip(2, {"S.B"}, {"S.B"}), slip(3, {}, {}),
                        slip(4, {"S.A", "S.B"}, {"S.A", "S.B"}), right({}, {})});
  EXPECT_EQ(grade.score, 3.0);
  EXPECT_NE(grade.story.find("slip 3: not caught"), std::string::npos);
  EXPECT_EQ(grade.story.find("secret"), std::string::npos);
}

TEST(OwnTests, ATestThatAccusesARightSolutionCatchesNothingAndTakesOneBack) {
  const Failed all = {"S.Always"}, both = {"S.A", "S.Always"};
  EXPECT_EQ(graded_own_tests(kFourSlips, {"S.Always"},
                             {slip(1, all, all), slip(2, all, all), slip(3, all, all),
                              slip(4, all, all), right(all, all)})
                .score,
            0.0);
  EXPECT_EQ(graded_own_tests(kFourSlips, {"S.A", "S.Always"},
                             {slip(1, both, both), slip(2, both, both), slip(3, all, all),
                              slip(4, all, all), right(all, all)})
                .score,
            1.0);
}

TEST(OwnTests, AVerdictThatIsNotRepeatedCatchesNothing) {
  const OwnTestsGrade grade =
      graded_own_tests(kFourSlips, {"S.Lot"},
                       {slip(1, {"S.Lot"}, {"S.Lot"}), slip(2, {"S.Lot"}, {}), slip(3, {}, {}),
                        slip(4, {}, {}), right({}, {})});
  EXPECT_EQ(grade.score, 0.0);
  EXPECT_NE(grade.story.find("S.Lot gave two verdicts"), std::string::npos);
}

TEST(OwnTests, TheShareIsEnoughForAllPoints) {
  OwnTestsRule rule = kFourSlips;
  rule.share = 0.5;
  const Failed a = {"S.A"};
  EXPECT_EQ(graded_own_tests(
                rule, {"S.A"},
                {slip(1, a, a), slip(2, a, a), slip(3, {}, {}), slip(4, {}, {}), right({}, {})})
                .score,
            4.0);
}

TEST(OwnTests, WithoutTestsThereAreNoPoints) {
  EXPECT_EQ(graded_own_tests(kFourSlips, {}, {slip(1, {}, {}), right({}, {})}).score, 0.0);
}

}  // namespace
}  // namespace tumble::grading
