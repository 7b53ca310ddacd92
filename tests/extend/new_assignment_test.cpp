// tumble new assignment: whole, consistent, or not at all.
#include <regex>

#include <gtest/gtest.h>

#include "framework/extend/check_points.h"
#include "framework/extend/unwritten.h"
#include "tests/extend/new_tree.h"

namespace tumble::testing {
namespace {

TEST(NewAssignment, HasEveryFileOfAnAssignment) {
  const NewTree tree;
  tree.make_a5();
  const auto files = tree.files();
  for (const char* file :
       {"assignments/a5_trial/a5_trial.h", "assignments/a5_trial/a5_trial.cpp",
        "assignments/a5_trial/a5_binding.h", "assignments/a5_trial/a5_binding.cpp",
        "assignments/a5_trial/rubric.json", "assignments/a5_trial/CMakeLists.txt",
        "assignments/a5_trial/scenes/trial.json", "tests/a5_trial/a5_fixtures.h",
        "tests/a5_trial/trial_test.cpp", "handouts/a5_trial.md",
        "solutions_private/a5_trial/a5_trial.cpp", "solutions_private/a5_trial/CMakeLists.txt",
        "solutions_private/a5_trial/rubric_hidden.json",
        "solutions_private/a5_trial/tests/trial_hidden_test.cpp",
        "solutions_private/a5_trial/mutants/mean_of_is_zero.slip",
        "solutions_private/a5_trial/flawed_submission/a5_trial.cpp"})
    EXPECT_TRUE(files.contains(file)) << file;
}

TEST(NewAssignment, LeavesNoMarkAndNoDraft) {
  const NewTree tree;
  tree.make_a5();
  for (const auto& [name, text] : tree.files()) {
    EXPECT_FALSE(std::regex_search(text, std::regex("@[a-z_A-Z]+@"))) << name;
    EXPECT_FALSE(name.starts_with(".new-")) << name;
    EXPECT_FALSE(name.ends_with(".in")) << name;
  }
}

// Whatever the number of functions: the points sum to 100, each test has some, each function has a
// test, and the handout prints the rubrics' sums.
TEST(NewAssignment, HasPointsThatFit) {
  for (const int count : {1, 2, 3, 7, 40}) {
    const NewTree tree;
    std::string functions;
    for (int i = 0; i < count; ++i)
      functions +=
          "// Number " + std::to_string(i) + ".\ndouble f" + std::to_string(i) + "(double x);\n";
    extend::new_assignment(tree.root(), "a5", "trial", tree.functions(functions));
    EXPECT_EQ(extend::check_points(tree.root(), "a5_trial"), std::vector<std::string>{}) << count;
  }
}

TEST(NewAssignment, RefusesMoreFunctionsThanThereArePoints) {
  const NewTree tree;
  std::string functions;
  for (int i = 0; i < 41; ++i) functions += "// A.\ndouble f" + std::to_string(i) + "(double x);\n";
  const std::string said = refusal_of(
      [&] { extend::new_assignment(tree.root(), "a5", "trial", tree.functions(functions)); });
  EXPECT_NE(said.find("at most 40"), std::string::npos) << said;
}

// Students have no answer to begin with, and the author none to forget: every expected value is
// one that nothing equals.
TEST(NewAssignment, SaysWhatIsLeftToBeWritten) {
  const NewTree tree;
  tree.make_a5();
  const auto places = extend::unwritten_of(tree.root(), "a5_trial");
  ASSERT_FALSE(places.empty());
  EXPECT_EQ(places.front().place, "assignments/a5_trial/a5_trial.h:4");
  int expected = 0;
  for (const extend::Unwritten& one : places)
    if (one.what.find("kUnwritten") != std::string::npos) ++expected;
  EXPECT_EQ(expected, 4) << "two functions, each with a public and a hidden test";
}

TEST(NewAssignment, IsRefusedWholeWhereItsNameIsTakenOrWrong) {
  const NewTree tree;
  tree.make_a5();
  const fs::path functions = tree.functions();
  const auto before = tree.files();
  const std::vector<std::array<std::string, 3>> refused = {
      {"a5", "other", "is taken by assignments/a5_trial"},
      {"a6", "trial", "is the name of a scene of a5_trial"},
      {"b6", "other", "is no id of an assignment"},
      {"a0", "other", "is no id of an assignment"},
      {"a6", "Other", "is no name of an assignment"},
      {"a6", "double", "is no name of an assignment"}};
  for (const auto& [id, name, words] : refused) {
    const std::string said = refusal_of(
        [&, &i = id, &n = name] { extend::new_assignment(tree.root(), i, n, functions); });
    EXPECT_NE(said.find(words), std::string::npos) << id << " " << name << ": " << said;
    EXPECT_EQ(tree.files(), before) << id << " " << name;
  }
}

// A file in the way of one part: no other part is left behind.
TEST(NewAssignment, LeavesNothingHalfWritten) {
  const NewTree tree;
  const fs::path functions = tree.functions();
  write_whole(tree.root() / "functions.h", "// A.\ndouble f(double x)\n");
  auto before = tree.files();
  EXPECT_NE(refusal_of([&] { extend::new_assignment(tree.root(), "a5", "trial", functions); }), "");
  EXPECT_EQ(tree.files(), before);

  before = tree.files();
  const std::vector<extend::NewFile> files = {{"tests/a5_trial/a_test.cpp", "int a;\n"},
                                              {"functions.h", "in the way\n"}};
  const std::string said = refusal_of([&] { extend::put_in_place(tree.root(), files); });
  EXPECT_NE(said.find("functions.h: is there already"), std::string::npos) << said;
  EXPECT_EQ(tree.files(), before);
}

TEST(Templates, NameTheLineOfAMarkWithoutAValue) {
  const std::string said = refusal_of([] {
    extend::filled("one\n@two@\n", {{"one", "1"}}, {}, "t.in");
  });
  EXPECT_NE(said.find("t.in:2: the mark @two@"), std::string::npos) << said;
  EXPECT_EQ(extend::filled("@@ a @b @one@\n", {{"one", "1"}}, {}, "t.in"), "@@ a @b 1\n");
}

}  // namespace
}  // namespace tumble::testing
