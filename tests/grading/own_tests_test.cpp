// The rule for points of a student's own tests, on runs that are given, what a page shows of them,
// and the modules that are kept for them.
#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/grading/grades/kept_file.h"
#include "framework/grading/grades/own_test_names.h"
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

// Of a file in which every test has a name of its own.
OwnTestsGrade graded(const OwnTestsRule& rule, const Failed& tests,
                     const std::vector<TriedModule>& modules) {
  return graded_own_tests(rule, tests, modules, tests);
}

TEST(OwnTests, EachSlipCaughtEarnsItsShare) {
  const OwnTestsGrade grade =
      graded(kFourSlips, {"S.A", "S.B"},
             {slip(1, {"S.A"}, {"S.A"}), slip(2, {"S.B"}, {"S.B"}), slip(3, {}, {}),
              slip(4, {"S.A", "S.B"}, {"S.A", "S.B"}), right({}, {})});
  EXPECT_EQ(grade.score, 3.0);
  EXPECT_NE(grade.names.find("slip 3 is secret, not caught"), std::string::npos) << grade.names;
}

// Which of its slips a test fails for is a bit for each of them, chosen by what the slip answered.
TEST(OwnTests, AStudentIsToldOfEachTestOnlyWhetherItCaughtASlip) {
  const auto told = [](const Failed& by_first, const Failed& by_second) {
    return graded(kFourSlips, {"S.A", "S.B"},
                  {slip(1, by_first, by_first), slip(2, by_second, by_second), slip(3, {}, {}),
                   slip(4, {}, {}), right({}, {})})
        .story;
  };
  const std::string story = told({"S.A"}, {"S.A", "S.B"});
  EXPECT_EQ(story, told({"S.A", "S.B"}, {"S.A"})) << "it depends on which slip a test caught";
  EXPECT_NE(story.find("S.A caught at least one slip\n"), std::string::npos) << story;
  EXPECT_NE(told({"S.A"}, {}).find("S.B caught no slip\n"), std::string::npos);
  EXPECT_EQ(story.find("secret"), std::string::npos) << story;
}

TEST(OwnTestNames, AreThoseThatStandInTheFile) {
  EXPECT_EQ(names_of_tests("TEST(Ray, Hits) {}\nTEST_F ( Hit ,\n Twice ) {}\nMY_TEST(No, One)\n"
                           "TEST_P(Many, Each) {} TYPED_TEST(Kind, Of) {} TEST(S, JOIN(a, b)) {}"),
            (Failed{"Ray.Hits", "Hit.Twice", "Many.Each", "Kind.Of"}));
}

TEST(OwnTestNames, WhatTheProgramReportsOnlyChoosesOneOfThem) {
  const Failed in_file = {"Ray.Hits", "Many.Each", "Kind.Of"};
  EXPECT_EQ(name_in_file("Ray.Hits", in_file), "Ray.Hits");
  EXPECT_EQ(name_in_file("Some/Many.Each/3", in_file), "Many.Each");
  EXPECT_EQ(name_in_file("Kind/0.Of", in_file), "Kind.Of");
  // an answer of the module, written as a name while the tests ran
  for (const char* made : {"Answer.3fe999999999999a", "Ray.Hits7", "Ray_.Hits", "x", ".", "Ray."})
    EXPECT_EQ(name_in_file(made, in_file), kUnnamedTest) << made;
}

TEST(OwnTests, ATestThatAccusesARightSolutionCatchesNothingAndTakesOneBack) {
  const Failed all = {"S.Always"}, both = {"S.A", "S.Always"};
  EXPECT_EQ(graded(kFourSlips, {"S.Always"},
                   {slip(1, all, all), slip(2, all, all), slip(3, all, all), slip(4, all, all),
                    right(all, all)})
                .score,
            0.0);
  EXPECT_EQ(graded(kFourSlips, {"S.A", "S.Always"},
                   {slip(1, both, both), slip(2, both, both), slip(3, all, all), slip(4, all, all),
                    right(all, all)})
                .score,
            1.0);
}

TEST(OwnTests, AnInstanceThatAccusesTakesNothingFromTheOthersOfItsName) {
  const Failed good = {"All/S.Each/0"}, bad = {"All/S.Each/1"}, both = {"All/S.Each/0", bad[0]};
  const OwnTestsGrade grade =
      graded_own_tests(kFourSlips, both,
                       {slip(1, both, both), slip(2, good, good), slip(3, good, good),
                        slip(4, {}, {}), right(bad, bad)},
                       {"S.Each"});
  EXPECT_EQ(grade.score, 2.0) << "three are caught, one is taken back";
  EXPECT_EQ(grade.story,
            "1 test: 3 of 4 slips caught, 4 needed for all 4 points; 1 test against right "
            "solutions or not repeatable (1 slip taken back)\n"
            "S.Each accuses a right solution: it catches nothing, and takes one slip back\n");
  EXPECT_NE(grade.names.find("slip 1 is secret, caught by S.Each;"), std::string::npos)
      << grade.names;
  EXPECT_EQ(grade.names.find("/"), std::string::npos) << "a reported name: " << grade.names;
}

// Made by a macro, or while the tests ran: how many there are is not shown.
TEST(OwnTests, EachTestWithoutANameInTheFileTakesASlipBack) {
  const auto with = [](std::size_t unnamed) {
    Failed tests = {"S.Good"}, accusing;
    for (std::size_t i = 0; i < unnamed; ++i) accusing.push_back("M.Made" + std::to_string(i));
    tests.insert(tests.end(), accusing.begin(), accusing.end());
    return graded_own_tests(kFourSlips, tests,
                            {slip(1, tests, tests), slip(2, tests, tests), slip(3, tests, tests),
                             slip(4, {}, {}), right(accusing, accusing)},
                            {"S.Good"});
  };
  EXPECT_EQ(with(1).score, 2.0);
  EXPECT_EQ(with(2).score, 1.0);
  EXPECT_EQ(with(50).score, 0.0);
  EXPECT_EQ(with(50).story, with(3).story) << "a student reads how many tests were reported";
  EXPECT_NE(with(50).story.find(kUnnamedTest), std::string::npos);
}

TEST(OwnTests, AVerdictThatIsNotRepeatedCatchesNothing) {
  const OwnTestsGrade grade = graded(kFourSlips, {"S.Lot"},
                                     {slip(1, {"S.Lot"}, {"S.Lot"}), slip(2, {"S.Lot"}, {}),
                                      slip(3, {}, {}), slip(4, {}, {}), right({}, {})});
  EXPECT_EQ(grade.score, 0.0);
  EXPECT_NE(grade.story.find("S.Lot gave two verdicts"), std::string::npos);
}

TEST(OwnTests, TheShareIsEnoughForAllPoints) {
  OwnTestsRule rule = kFourSlips;
  rule.share = 0.5;
  const Failed a = {"S.A"};
  EXPECT_EQ(graded(rule, {"S.A"},
                   {slip(1, a, a), slip(2, a, a), slip(3, {}, {}), slip(4, {}, {}), right({}, {})})
                .score,
            4.0);
}

TEST(OwnTests, WithoutTestsThereAreNoPoints) {
  EXPECT_EQ(graded(kFourSlips, {}, {slip(1, {}, {}), right({}, {})}).score, 0.0);
}

TEST(KeptFile, CountsOnlyWholeAndUnderItsOwnName) {
  const PrivateFolder folder;
  const auto file = folder.path() / "one.module";
  const std::string bytes(
      "\x7f"
      "ELF\0\n slip",
      11);
  EXPECT_FALSE(kept_file(file)) << "there is none";
  keep_file(file, bytes);
  ASSERT_EQ(kept_file(file), bytes);
  const std::string whole = text_of(file);

  std::string changed = whole;
  changed.back() ^= 1;
  for (const std::string& text : {changed, whole + 'x', whole.substr(0, whole.size() - 1),
                                  whole.substr(0, 65), whole.substr(0, 20), std::string(), bytes}) {
    write_whole(file, text);
    EXPECT_FALSE(kept_file(file)) << text.size();
  }
  write_whole(folder.path() / "other.module", whole);
  EXPECT_FALSE(kept_file(folder.path() / "other.module")) << "another module's bytes";

  keep_file(file, bytes);
  EXPECT_EQ(kept_file(file), bytes) << "it cannot be made again";
}

}  // namespace
}  // namespace tumble::grading
