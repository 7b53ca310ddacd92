// How a hostile submission is written, what is made of it, and what counts as withstood.
#include <unistd.h>

#include <fstream>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/attacks/compare_results.h"
#include "framework/grading/attacks/make_attack.h"
#include "framework/grading/attacks/watchers.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHead = "// attack: x - ends early\n// kind: early exit\n";
constexpr const char* kBase =
    "namespace a1 {\n"
    "// See also twice(x).\n"
    "double once(double x) {\n"
    "  return twice(x) / 2;\n"
    "}\n"
    "double twice(double x) {\n"
    "  return 2 * x;\n"
    "}\n"
    "}\n";

class AttackFile : public ::testing::Test {
 protected:
  Attack read(const std::string& text) const {
    write_whole(file, text);
    return read_attack(file);
  }
  std::string refusal_of(const std::string& text) const {
    try {
      read(text);
    } catch (const UserError& error) {
      return error.what();
    }
    ADD_FAILURE() << "was taken: " << text;
    return "";
  }
  PrivateFolder folder;
  const fs::path file = folder.path() / "x.attack";
};

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(AttackFile, IsMadeOfItsBase) {
  const std::string head = kHead;
  const Attack attack = read(head +
                             "// verdict: crashed\n// base: reference\n"
                             "@@ before\nint first;\n@@ body twice\n  exit({{port}});\n"
                             "@@ after\nint last;\n@@ file more/{{me}}.h\nint more;\n"
                             "@@ link also\n{{secret}}\n");
  EXPECT_EQ(attack.harmless(), "without-twice");
  const fs::path made = folder.path() / "made";
  make_attack(attack, kBase, "a1.cpp", {{"port", "80"}, {"me", "eve"}, {"secret", "/s"}}, made);
  const std::string text = text_of(made / "a1.cpp");
  EXPECT_TRUE(text.starts_with("int first;\nnamespace a1 {\n")) << text;
  EXPECT_TRUE(holds(text, "double twice(double x) {\n  exit(80);\n  return 2 * x;\n")) << text;
  EXPECT_TRUE(text.ends_with("}\nint last;\n")) << text;
  EXPECT_EQ(text_of(made / "more/eve.h"), "int more;\n");
  EXPECT_EQ(fs::read_symlink(made / "also"), "/s");
}

TEST_F(AttackFile, MistakesAreNamedWithFileAndLine) {
  const std::string head = kHead;
  EXPECT_TRUE(holds(refusal_of(head + "// verdict: crashed\n// bsae: stub\n"),
                    file.string() + ":4: 'bsae' is no word of a head"));
  EXPECT_TRUE(holds(refusal_of(head + "// verdict: crash\n"), ":3: 'crash' is no verdict"));
  EXPECT_TRUE(holds(refusal_of(head), "needs attack, kind and verdict"));
  EXPECT_TRUE(holds(refusal_of("// attack: y - z\n"), "does not begin with the file's name"));
  EXPECT_TRUE(holds(refusal_of(head + "// verdict: same\n@@ inside\n"), ":4: 'inside' begins no"));
  EXPECT_TRUE(holds(refusal_of(head + "// verdict: wrong\n// state: does not compile\n"),
                    "is not judged has no verdicts"));
  EXPECT_THROW(with_body(kBase, "thrice", "", "here"), UserError);
  EXPECT_THROW(with_places("{{nowhere}}", {{"port", "80"}}, "here"), UserError);
}

// ---- what counts ----

std::string results(const std::string& first, double first_points, const std::string& second) {
  const auto test = [](const char* name, const std::string& verdict, double points) {
    return R"({"score": )" + std::to_string(points) + R"(, "output": "it says so",
      "extra_data": {"test": ")" +
           name + R"(", "verdict": ")" + verdict + "\"}}";
  };
  return R"({"score": 1, "extra_data": {"state": "judged"}, "tests": [)" +
         test("A.One", first, first_points) + ", " + test("A.Two", second, 0.0) + "]}";
}

class Compared : public AttackFile {
 protected:
  std::string faults_of(const std::string& attack, const std::string& found) const {
    AttackResult result;
    compare_results(read(kHead + attack), found, "{}",
                    results("not attempted", 0.0, "not attempted"), result);
    std::string all;
    for (const std::string& fault : result.faults) all += fault + "\n";
    return all;
  }
};

TEST_F(Compared, TheVerdictOfItsHeadIsNoFault) {
  EXPECT_EQ(faults_of("// verdict: crashed\n// story: says so\n",
                      results("crashed", 0.0, "not attempted")),
            "");
  EXPECT_EQ(faults_of("// verdict: same\n", results("not attempted", 0.0, "not attempted")), "");
}

TEST_F(Compared, GainsOtherVerdictsAndNothingAttackedAreFaults) {
  EXPECT_TRUE(holds(faults_of("// verdict: crashed\n", results("right", 1.0, "crashed")),
                    "it gains in A.One: 1 points"));
  EXPECT_TRUE(holds(faults_of("// verdict: crashed\n", results("wrong", 0.0, "crashed")),
                    "A.One is 'wrong', which is not expected"));
  EXPECT_TRUE(
      holds(faults_of("// verdict: crashed\n", results("not attempted", 0.0, "not attempted")),
            "nothing was attacked"));
  EXPECT_TRUE(holds(faults_of("// verdict: same\n", results("fault of the grader", 0.0, "wrong")),
                    "'fault of the grader', which is not expected"));
  EXPECT_TRUE(holds(
      faults_of("// verdict: crashed\n// story: read: 0\n", results("crashed", 0.0, "crashed")),
      "no story holds 'read: 0'"));
  EXPECT_TRUE(holds(faults_of("// verdict: same\n// state: does not compile\n",
                              results("not attempted", 0.0, "not attempted")),
                    "it is 'judged', which is not expected"));
  EXPECT_TRUE(holds(faults_of("// verdict: same\n", "half a file"), "it is no JSON"));
}

TEST_F(Compared, ThatAWrongAnswerMayBeRightSomewhereIsSaidByItsHead) {
  EXPECT_EQ(faults_of("// verdict: wrong, right\n", results("right", 1.0, "wrong")), "");
}

// ---- what is left ----

TEST(Watchers, NameProcessesAndFilesThatAreLeft) {
  PrivateFolder folder;
  Watchers watchers("tumble-mark-of-a-test-" + std::to_string(::getpid()));
  EXPECT_TRUE(watchers.found({folder.path()}).empty());
  if (::fork() == 0) {
    if (::fork() == 0) {
      ::setsid();
      ::pause();
    }
    ::_exit(0);
  }
  fs::create_directories(folder.path() / "deep");
  std::ofstream(folder.path() / "deep" / (watchers.socket_name() + ".txt")) << "x";
  const auto faults = watchers.found({folder.path()});
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_TRUE(holds(faults[0], "a process was left")) << faults[0];
  EXPECT_TRUE(holds(faults[1], "a file was left")) << faults[1];
  fs::remove_all(folder.path() / "deep");
  EXPECT_TRUE(watchers.found({folder.path()}).empty()) << "the process was ended";
}

}  // namespace
}  // namespace tumble::grading
