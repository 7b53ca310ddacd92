// tumble new effect, scene, slip, test.
#include <sstream>

#include <gtest/gtest.h>

#include "framework/extend/check_points.h"
#include "framework/extend/new_parts.h"
#include "tests/extend/new_tree.h"

namespace tumble::testing {
namespace {

TEST(NewTest, HasAnEntryAndChangesNoSum) {
  const NewTree tree;
  tree.make_a5();
  extend::new_test(tree.root(), "a5", "MeanOf.IsHalfTheSum", false);
  extend::new_test(tree.root(), "a5", "MeanOf.IsSymmetric", true);
  EXPECT_EQ(extend::check_points(tree.root(), "a5_trial"), std::vector<std::string>{});
  EXPECT_NE(text_of(tree.root() / "assignments/a5_trial/rubric.json")
                .find("\"title\": \"Is half the sum\""),
            std::string::npos);
  EXPECT_NE(text_of(tree.root() / "tests/a5_trial/mean_of_is_half_the_sum_test.cpp")
                .find("namespace tumble::a5_testing {"),
            std::string::npos);
}

// A stub throws in it: "not attempted", like every test of the assignment.
TEST(NewTest, CallsTheFunctionOfItsSuite) {
  const NewTree tree;
  tree.make_a5();
  extend::new_test(tree.root(), "a5", "LargerPart.IsALength", false);
  const std::string test = text_of(tree.root() / "tests/a5_trial/larger_part_is_a_length_test.cpp");
  EXPECT_NE(test.find("under_test<Module>().larger_part(Vector3d(1, 2, 3))"), std::string::npos)
      << test;
}

TEST(NewTest, IsRefusedWhereItsNameIsTakenOrWrong) {
  const NewTree tree;
  tree.make_a5();
  const auto before = tree.files();
  for (const auto& [test, words] : std::vector<std::pair<std::string, std::string>>{
           {"MeanOf.IsRightInAPlainCase", "is there already: tests/a5_trial/trial_test.cpp:"},
           {"MeanOf", "is no name of a test"},
           {"mean_of.Works", "is no name of a test"}}) {
    const std::string said =
        refusal_of([&, &t = test] { extend::new_test(tree.root(), "a5", t, false); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }
  EXPECT_NE(
      refusal_of([&] { extend::new_test(tree.root(), "a7", "A.B", false); }).find("Known: a5."),
      std::string::npos);
  EXPECT_EQ(tree.files(), before);
}

TEST(NewSlip, BeginsWithALineOfTheFunction) {
  const NewTree tree;
  tree.make_a5();
  write_whole(tree.root() / "solutions_private/a5_trial/a5_trial.cpp",
              "double mean_of(double a, double b) {\n  const double sum = a + b;\n"
              "  return sum / 2;\n}\n\nVector3d larger_part(const Vector3d& arm_world) {\n"
              "  return 2 * arm_world;\n}\n");
  extend::new_slip(tree.root(), "a5", "twice", "larger_part");
  const std::string slip = text_of(tree.root() / "solutions_private/a5_trial/mutants/twice.slip");
  EXPECT_NE(slip.find("// mutant: twice - "), std::string::npos) << slip;
  EXPECT_NE(slip.find("\n-  return 2 * arm_world;\n+  return 2 * arm_world;"), std::string::npos)
      << slip;
  const std::string said =
      refusal_of([&] { extend::new_slip(tree.root(), "a5", "other", "larger_parts"); });
  EXPECT_NE(said.find("Did you mean 'larger_part'?"), std::string::npos) << said;
}

TEST(NewScene, IsNamedOnceInAllAssignments) {
  const NewTree tree;
  tree.make_a5();
  extend::new_scene(tree.root(), "a5", "tall_drop");
  EXPECT_NE(text_of(tree.root() / "assignments/a5_trial/scenes/tall_drop.json")
                .find("\"needs\": [\"a5\"]"),
            std::string::npos);
  const std::string said = refusal_of([&] { extend::new_scene(tree.root(), "a5", "trial"); });
  EXPECT_NE(said.find("is a scene of a5_trial already"), std::string::npos) << said;
}

TEST(NewEffect, IsAFolderAndATest) {
  const NewTree tree;
  extend::new_effect(tree.root(), "low_wind");
  const auto files = tree.files();
  EXPECT_TRUE(files.contains("framework/effects/low_wind/low_wind_effect.cpp"));
  EXPECT_TRUE(files.contains("framework/effects/low_wind/schema.json"));
  EXPECT_TRUE(files.contains("tests/effects/low_wind_test.cpp"));
  EXPECT_NE(files.at("framework/effects/low_wind/low_wind_effect.cpp").find("kLowWindSchema"),
            std::string::npos);
  EXPECT_NE(
      refusal_of([&] { extend::new_effect(tree.root(), "water"); }).find("is an effect already"),
      std::string::npos);
}

// In messages an effect is named in words, as "point force" is; in files by the words of its key.
TEST(NewEffect, IsNamedInWordsInWhatItSays) {
  const NewTree tree;
  extend::new_effect(tree.root(), "low_wind");
  const std::string code = tree.files().at("framework/effects/low_wind/low_wind_effect.cpp");
  for (const char* words : {"name() const override { return \"low wind\"; }",
                            "key() const override { return \"low_wind\"; }",
                            "index.of(spec.body, \"low wind\")", "the low wind of body"})
    EXPECT_NE(code.find(words), std::string::npos) << words << "\n" << code;
}

TEST(NewEffect, HasNoLineThatTheHouseRefuses) {
  constexpr std::size_t kColumns = 100;  // of code: tests/house
  const NewTree tree;
  tree.make_a5();
  extend::new_effect(tree.root(), "low_wind", "a5.larger_part");
  for (const auto& [name, text] : tree.files()) {
    if (name.find("low_wind") == std::string::npos || name.ends_with(".json")) continue;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(line.size(), kColumns) << name << ": " << line;
  }
}

// The effect's folder has its law, and the assignment's binding sets it: no other old file.
TEST(NewEffect, ThatAsksAFunctionHasItsLawAndIsBound) {
  const NewTree tree;
  tree.make_a5();
  const auto before = tree.files();
  extend::new_effect(tree.root(), "low_wind", "a5.larger_part");
  const auto files = tree.files();
  const std::string& header = files.at("framework/effects/low_wind/low_wind.h");
  EXPECT_NE(header.find("using Function = Vector3d(const Vector3d& arm_world);"), std::string::npos)
      << header;
  EXPECT_NE(header.find(".assignment = \"a5\""), std::string::npos) << header;
  EXPECT_NE(files.at("framework/effects/low_wind/low_wind_effect.cpp")
                .find("larger_part_(acting.laws.of<LowWindLaw>())"),
            std::string::npos);
  const std::string& binding = files.at("assignments/a5_trial/a5_binding.cpp");
  for (const char* words : {"\n#include \"framework/effects/low_wind/low_wind.h\"\n",
                            "void bind(const Module& module, Laws& laws) {\n"
                            "  laws.set<effects::LowWindLaw>(module.larger_part);\n}\n"})
    EXPECT_NE(binding.find(words), std::string::npos) << binding;
  for (const auto& [name, text] : before) {
    if (name == "assignments/a5_trial/a5_binding.cpp") continue;
    EXPECT_EQ(files.at(name), text) << name;
  }
  // A second one stands beside it.
  extend::new_effect(tree.root(), "high_wind", "a5.mean_of");
  const std::string both = tree.files().at("assignments/a5_trial/a5_binding.cpp");
  for (const char* words : {"laws.set<effects::HighWindLaw>(module.mean_of);",
                            "laws.set<effects::LowWindLaw>(module.larger_part);"})
    EXPECT_NE(both.find(words), std::string::npos) << both;
}

TEST(NewEffect, ThatAsksAFunctionWhichIsNotThereLeavesNothing) {
  const NewTree tree;
  tree.make_a5();
  tree.functions();
  const auto before = tree.files();
  for (const auto& [function, words] : std::vector<std::pair<std::string, std::string>>{
           {"a5.larger_parts", "Did you mean 'larger_part'?"},
           {"a7.mean_of", "there is no assignment of this name"},
           {"mean_of", "names no assignment"}}) {
    const std::string said =
        refusal_of([&, &f = function] { extend::new_effect(tree.root(), "low_wind", f); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }
  EXPECT_EQ(tree.files(), before);
}

}  // namespace
}  // namespace tumble::testing
