// Points, tests, functions and the handout's table: what does not fit is said with file and line.
#include <gtest/gtest.h>

#include "framework/extend/check_points.h"
#include "tests/extend/new_tree.h"

namespace tumble::testing {
namespace {

constexpr const char* kRubric = "assignments/a5_trial/rubric.json";
constexpr const char* kTests = "tests/a5_trial/trial_test.cpp";

/// The one fault that a change of a right assignment makes; all of them where there are more.
std::string fault_of_change(const std::string& file, const std::string& from,
                            const std::string& to) {
  const NewTree tree;
  tree.make_a5();
  tree.replace(file, from, to);
  std::string all;
  for (const std::string& fault : extend::check_points(tree.root(), "a5_trial"))
    all += (all.empty() ? "" : "\n") + fault;
  return all;
}

TEST(CheckPoints, ASumOtherThan100) {
  const std::string said = fault_of_change(kRubric, "\"points\": 30", "\"points\": 29");
  EXPECT_EQ(said.find("assignments/a5_trial/rubric.json:1: the points sum to 99: 59 here and 40 in "
                      "solutions_private/a5_trial/rubric_hidden.json"),
            0u)
      << said;
  // the handout still has the old sum: said, with the row that is right
  EXPECT_NE(said.find("handouts/a5_trial.md:48: the row of level basic is not the rubrics'. It "
                      "ends with  | 59 | 0 | 59 |"),
            std::string::npos)
      << said;
}

TEST(CheckPoints, PointsMovedWithinALevelNeedNoOtherChange) {
  const NewTree tree;
  tree.make_a5();
  tree.replace(kRubric, "\"points\": 30", "\"points\": 29");
  tree.replace(kRubric, "\"points\": 30", "\"points\": 31");
  EXPECT_EQ(extend::check_points(tree.root(), "a5_trial"), std::vector<std::string>{});
}

TEST(CheckPoints, ALevelWithoutPointsNeedsNoRow) {
  const NewTree tree;
  tree.make_a5();
  const auto remove_row = [&](const std::string& level) {
    std::string text = text_of(tree.root() / "handouts/a5_trial.md");
    const std::size_t begin = text.find("\n| " + level + " |");
    ASSERT_NE(begin, std::string::npos) << level;
    text.erase(begin, text.find('\n', begin + 1) - begin);
    write_whole(tree.root() / "handouts/a5_trial.md", text);
  };
  remove_row("advanced");
  EXPECT_EQ(extend::check_points(tree.root(), "a5_trial"), std::vector<std::string>{});
  remove_row("basic");
  const auto faults = extend::check_points(tree.root(), "a5_trial");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NE(faults[0].find("the table has no row of level basic"), std::string::npos) << faults[0];
}

// Points are changed in one place: the handout follows.
TEST(CheckPoints, TheHandoutIsWrittenAfterTheRubrics) {
  const NewTree tree;
  tree.make_a5();
  tree.replace(kRubric, "\"points\": 30, \"level\": \"basic\"",
               "\"points\": 30, \"level\": \"advanced\"");
  EXPECT_EQ(extend::check_points(tree.root(), "a5_trial").size(), 2u);
  write_whole(tree.root() / "handouts/a5_trial.md",
              extend::with_points_of_rubrics(tree.root(), "a5_trial"));
  EXPECT_EQ(extend::check_points(tree.root(), "a5_trial"), std::vector<std::string>{});
}

TEST(CheckPoints, ATestWithoutPointsAndPointsForNoTest) {
  const std::string said =
      fault_of_change(kTests, "TEST(MeanOf, IsRight", "TEST(MeanOf, IsAlmostRight");
  EXPECT_NE(said.find("tests/a5_trial/trial_test.cpp:8: MeanOf.IsAlmostRightInAPlainCase is worth "
                      "no points"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("assignments/a5_trial/rubric.json:2: names MeanOf.IsRightInAPlainCase, and "
                      "no test is called so. Did you mean 'MeanOf.IsAlmostRightInAPlainCase'?"),
            std::string::npos)
      << said;
}

TEST(CheckPoints, AFunctionThatNoTestCalls) {
  const NewTree tree;
  tree.make_a5();
  for (const char* file : {kTests, "solutions_private/a5_trial/tests/trial_hidden_test.cpp"})
    tree.replace(file, "student().mean_of(", "std::max(");
  const auto faults = extend::check_points(tree.root(), "a5_trial");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].find(place_of(tree, "assignments/a5_trial/a5_trial.h", "double mean_of(") +
                           ": no test calls mean_of."),
            0u)
      << faults[0];
}

TEST(CheckPoints, AnEntryOfTheOtherRubric) {
  const NewTree tree;
  tree.make_a5();
  tree.replace("solutions_private/a5_trial/rubric_hidden.json", "HiddenMeanOf.ObeysItsLaw",
               "MeanOf.IsRightInAPlainCase");
  std::string all;
  for (const std::string& fault : extend::check_points(tree.root(), "a5_trial"))
    all += fault + "\n";
  EXPECT_NE(all.find("trial_hidden_test.cpp:8: HiddenMeanOf.ObeysItsLaw is worth no points"),
            std::string::npos)
      << all;
  EXPECT_NE(all.find("rubric_hidden.json:2: MeanOf.IsRightInAPlainCase is in "
                     "assignments/a5_trial/rubric.json too"),
            std::string::npos)
      << all;
}

// A rule for students' own tests stands in two files: points in one, slips to catch in the other.
TEST(CheckPoints, ARuleForOwnTestsNamesSlipsThatAreThere) {
  const std::string hidden = "solutions_private/a5_trial/rubric_hidden.json";
  const NewTree tree;
  tree.make_a5();
  const auto faults = [&] {
    std::string all;
    for (const std::string& fault : extend::check_points(tree.root(), "a5_trial"))
      all += fault + "\n";
    return all;
  };
  const auto rule = [&](const std::string& file, const std::string& before,
                        const std::string& after) {
    tree.replace(file, "\"own_tests\": " + before, "\"own_tests\": " + after);
  };
  std::string slip;
  for (const auto& entry :
       fs::directory_iterator(tree.root() / "solutions_private/a5_trial/mutants"))
    slip = '"' + entry.path().stem().string() + '"';
  ASSERT_FALSE(slip.empty());

  tree.replace(kRubric, "{", "{\"own_tests\": {\"points\": 5},");
  EXPECT_NE(faults().find(std::string(kRubric) + ":1: gives points for students' own tests, and no "
                                                 "slip is there to catch"),
            std::string::npos)
      << faults();
  tree.replace(hidden, "{", "{\"own_tests\": {\"slips\": [" + slip + "]},");
  EXPECT_EQ(faults(), "");
  rule(hidden, "{\"slips\": [" + slip, "{\"slips\": [" + slip + "," + slip);
  EXPECT_NE(faults().find("twice"), std::string::npos) << faults();
  rule(hidden, "{\"slips\": [" + slip + "," + slip, "{\"slips\": [\"never_written\"");
  EXPECT_NE(faults().find("names the slip never_written, and "), std::string::npos) << faults();
  rule(kRubric, "{\"points\": 5}", "{\"points\": 0}");
  EXPECT_NE(faults().find("there are no points for them"), std::string::npos) << faults();
}

TEST(CheckPoints, ARubricThatCannotBeRead) {
  const std::string said = fault_of_change(kRubric, "\"level\": \"basic\"", "\"level\": \"easy\"");
  EXPECT_EQ(said.find("assignments/a5_trial/rubric.json"), 0u) << said;
  EXPECT_NE(said.find("unknown level 'easy'"), std::string::npos) << said;
}

}  // namespace
}  // namespace tumble::testing
