// The shown part of a compiler's or linker's output: the student's own line first.
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/grading/compiler/build_module.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/core/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

class CompilerWords : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }
  PrivateFolder folder_;
};

// Output of GCC 12, shortened.
constexpr const char* kEigen = R"(In file included from /usr/include/eigen3/Eigen/Core:164,
                 from mine.cpp:1:
/usr/include/eigen3/Eigen/src/Core/CwiseBinaryOp.h: In instantiation of 'Eigen::CwiseBinaryOp<...>':
/usr/include/eigen3/Eigen/src/plugins/CommonCwiseBinaryOps.h:27:1:   required from 'const Eigen::CwiseBinaryOp<...>'
mine.cpp:3:12:   required from here
/usr/include/eigen3/Eigen/src/Core/CwiseBinaryOp.h:115:7: error: )"
                               R"(static assertion failed: YOU_MIXED_MATRICES_OF_DIFFERENT_SIZES
  115 |       EIGEN_STATIC_ASSERT_SAME_MATRIX_SIZE(Lhs, Rhs)
      |       ^~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~~
/usr/include/eigen3/Eigen/src/Core/CwiseBinaryOp.h:115:7: note: evaluates to false
/usr/include/eigen3/Eigen/src/Core/AssignEvaluator.h: In instantiation of 'void call_assignment_no_alias(...)':
mine.cpp:3:12:   required from here
/usr/include/eigen3/Eigen/src/Core/AssignEvaluator.h:887:3: error: )"
                               R"(static assertion failed: YOU_MIXED_MATRICES_OF_DIFFERENT_SIZES
)";

TEST_F(CompilerWords, ErrorInsideALibraryBeginsWithTheStudentsLine) {
  const fs::path mine = write("mine.cpp", "// 1\n// 2\n  return a + b;\n");
  EXPECT_EQ(compiler_story(kEigen, mine),
            "mine.cpp:3:12: error: required from here\n"
            "    3 |   return a + b;\n"
            "      |            ^\n"
            "      Eigen/src/Core/CwiseBinaryOp.h:115:7: static assertion failed: "
            "YOU_MIXED_MATRICES_OF_DIFFERENT_SIZES\n");
}

TEST_F(CompilerWords, MissingFunctionIsNamedWithItsDeclaration) {
  const fs::path header = write("a9.h",
                                "namespace tumble::a9 {\n/// What it does.\ndouble speed(double "
                                "way,\n             double time);\n}\n");
  const fs::path mine = write("mine.cpp", "#include \"a9.h\"\n");
  for (const char* said : {"mold: error: undefined symbol: tumble::a9::speed(double, double)\n>>> "
                           "referenced by check.cpp\n",
                           "/usr/bin/ld: /tmp/x.o: in function `m':\nx.cpp:(.text+0x1): undefined "
                           "reference to `tumble::a9::speed(double, double)'\n"})
    EXPECT_EQ(compiler_story(said, mine, header),
              "mine.cpp: error: speed is missing: the file does not define it\n  expected: double "
              "speed(double way, double time)\n  declared in a9.h:3\n");
}

TEST_F(CompilerWords, FunctionWithOtherArgumentsIsShownBesideItsDeclaration) {
  const fs::path header =
      write("a9.h", "namespace tumble::a9 {\ndouble speed(double way, double time);\n}\n");
  const fs::path mine = write(
      "mine.cpp", "namespace tumble::a9 {\n\ndouble speed(double way) {\n  return way;\n}\n}\n");
  const std::string story = compiler_story(
      "mold: error: undefined symbol: tumble::a9::speed(double, double)\n", mine, header);
  EXPECT_EQ(
      story.find(
          "mine.cpp:3: error: speed is written here, but not as the header declares it\n  here:    "
          " double speed(double way)\n  expected: double speed(double way, double time)\n"),
      0u)
      << story;
}

TEST_F(CompilerWords, OnlyWarningsOfTheStudentsFileAreShown) {
  const fs::path mine = write("mine.cpp", "");
  const std::string said =
      "mine.cpp: In function 'double f(double)':\n"
      "mine.cpp:3:78: warning: control reaches end of non-void function [-Wreturn-type]\n    3 | "
      "double f(double a) {}\n      |      ^\n"
      "/usr/include/eigen3/Eigen/x.h:3:78: warning: something of a library [-Wextra]\n"
      "mine.cpp:9:7: warning: unused parameter 'b' [-Wunused-parameter]\n";
  EXPECT_EQ(compiler_warnings(said, mine),
            "mine.cpp:3:78: warning: control reaches end of non-void function [-Wreturn-type]\n    "
            "3 | double f(double a) {}\n      |      ^\n");
  EXPECT_EQ(compiler_warnings("", mine), "");
}

// A file may print what looks like a compiler's line, with a number that no line has.
TEST_F(CompilerWords, NumbersBeyondEveryLineAreNoPlaces) {
  const fs::path mine = write("mine.cpp", "static_assert(false);\n");
  const std::string said =
      "mine.cpp:99999999999999:1: error: boo\nmine.cpp:1:99999999999999: error: boo\n"
      "mine.cpp:99999999999999:1:   required from here\n"
      "mine.cpp:1:1: error: static assertion failed\n";
  const std::string story = compiler_story(said, mine);
  EXPECT_NE(story.find("mine.cpp:1:1: error: static assertion failed"), std::string::npos) << story;
  EXPECT_EQ(story.find("99999999999999"), std::string::npos) << story;
}

TEST_F(CompilerWords, AFileThatDoesNotNameTheHeaderDefinesNothing) {
  const fs::path header = "assignments/a2_integration/a2_integration.h";
  const auto why = [&](const std::string& text) { return why_nothing("mine.cpp", text, header); };
  EXPECT_EQ(why("#include \"assignments/a2_integration/a2_integration.h\"\n"), "");
  EXPECT_EQ(why("#include \"helpers.h\"\n"), "") << "it may include the header";
  EXPECT_EQ(why("// to do\n#include <vector>\n"),
            "mine.cpp:1:1: error: the file does not include "
            "\"assignments/a2_integration/a2_integration.h\" and defines nothing of it. Is it "
            "empty, or another file?");
  const std::string other = why(" # include \"assignments/a1_impulse/a1_impulse.h\"\n");
  EXPECT_TRUE(other.ends_with(" Is it the file of a1_impulse?")) << other;
}

// A hostile file causes very long lines: they are cut, because a regex would recurse too deep.
TEST_F(CompilerWords, LinesOfAMegabyteDoNoHarm) {
  const std::string longest(1u << 20, 'a');
  const fs::path header = write("a9.h", "double speed(double way);\n"),
                 mine = write("mine.cpp", "double " + longest + "speed(" + longest + "\n");
  EXPECT_NE(compiler_story("mine.cpp:1:1: error: " + longest + "\n    1 | " + longest + "\n", mine)
                .find("mine.cpp:1:1: error: aaa"),
            std::string::npos);
  EXPECT_NE(compiler_story("mold: error: undefined symbol: tumble::a9::speed(double)" + longest,
                           mine, header)
                .find("speed"),
            std::string::npos);
  EXPECT_LT(compiler_warnings("mine.cpp:1:1: warning: " + longest + "\n", mine).size(), 1000u);
}

// GCC takes no precompiled header made with other flags, and says nothing: a check would take 2 s
// longer, whatever the student's file is.
TEST_F(CompilerWords, TheStudentsOwnCompilationUsesThePrecompiledHeader) {
  const fs::path file = write("a1_impulse.cpp", "int answer() { return 42; }\n");
  std::vector<std::string> words =
      own_compilation(test::source_dir(), test::binary_dir(), file, folder_.path() / "a1.so");
  words.push_back("-Winvalid-pch");
  const ProgramOutcome outcome = run_program(words, Output::kCaptured);
  EXPECT_EQ(outcome.code, 0) << outcome.printed;
  EXPECT_EQ(outcome.printed, "");
}

}  // namespace
}  // namespace tumble::grading
