// Checks before a release, on small trees made for the tests.
#include <fstream>

#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/grading/course/release_checks.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

class ReleaseChecks : public ::testing::Test {
 protected:
  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((folder_.path() / file).parent_path());
    std::ofstream(folder_.path() / file) << text;
  }
  PrivateFolder folder_;
};

constexpr const char* kSolution = R"(#include "assignments/a9_x/a9_x.h"
namespace tumble::a9 {
double norm_of_sum(const Vector3d& first, const Vector3d& second) {
  const Vector3d sum_of_both_vectors = first + second;
  const double squared_length_of_sum = sum_of_both_vectors.dot(sum_of_both_vectors);
  if (squared_length_of_sum <= kSmallestSquare) return 0.0;
  const double length = std::sqrt(squared_length_of_sum);
  return length * (1.0 + 0.25 * length / (1.0 + length));
}
}  // namespace tumble::a9
)";

std::vector<PrivateFile> secrets() {
  return {{"solutions_private/a9_x/a9_x.cpp", kSolution, false}};
}

TEST_F(ReleaseChecks, WholeCopyUnderAnotherNameIsNamed) {
  write("models/notes.txt", kSolution);
  const auto found = leaks(folder_.path(), secrets());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where, "models/notes.txt");
}

TEST_F(ReleaseChecks, ThreeLinesOfASolutionAreNamedWithBothPlaces) {
  write("handouts/a9_x.md",
        "Theory.\n\n  const Vector3d sum_of_both_vectors = first + second;\n  const double "
        "squared_length_of_sum = sum_of_both_vectors.dot(sum_of_both_vectors);\n"
        "  if (squared_length_of_sum <= kSmallestSquare) return 0.0;\n");
  const auto found = leaks(folder_.path(), secrets());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where, "handouts/a9_x.md:3");
  EXPECT_EQ(found[0].problem, "holds three lines of solutions_private/a9_x/a9_x.cpp:4");
}

// A text that was made of two files says of each line where it is from.
TEST_F(ReleaseChecks, APassageOfAMadeTextIsNamedWithThePlaceThatItIsFrom) {
  PrivateFile made{"solutions_private/a9_x/mutants/s.slip", kSolution, false};
  for (int line = 1; line <= 10; ++line)
    made.places.push_back(line == 4 ? "s.slip:7" : "a9_x.cpp:" + std::to_string(line));
  write("handouts/a9_x.md",
        "  const Vector3d sum_of_both_vectors = first + second;\n  const double "
        "squared_length_of_sum = sum_of_both_vectors.dot(sum_of_both_vectors);\n"
        "  if (squared_length_of_sum <= kSmallestSquare) return 0.0;\n");
  const auto found = leaks(folder_.path(), {made});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].problem, "holds three lines of s.slip:7");
}

// Different line ends, spaces and comments do not hide the tokens.
TEST_F(ReleaseChecks, ReformattedPassageIsNamed) {
  std::string text;
  for (const char c : std::string(kSolution).substr(std::string(kSolution).find("double norm")))
    text += c == '\n' ? std::string(" /* mine */ ") : std::string(1, c);
  write("framework/core/sum.h", text);
  const auto found = leaks(folder_.path(), secrets());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where, "framework/core/sum.h:1");
}

TEST_F(ReleaseChecks, TextOfTheModulesHeaderIsNotSecret) {
  const std::string helper =
      "inline double helper(double a) {\n  const double doubled_and_one_more = 2.0 * a + 1.0;\n  "
      "const double halved_again_and_less = doubled_and_one_more / 2.0 - 0.5;\n  return "
      "halved_again_and_less;\n}\n";
  write("assignments/a9_x/a9_x.h", helper);
  write("tests/a9_x/t.cpp", helper);
  EXPECT_TRUE(leaks(folder_.path(),
                    {{"solutions_private/a9_x/a9_x.cpp", helper + "double other();\n", false}})
                  .empty());
}

constexpr const char* kStub =
    "// Your work.\n#include \"assignments/a9_x/a9_x.h\"\n\nnamespace tumble::a9 "
    "{\n\nstd::vector<double> roots(const std::vector<double>&, double) {\n"
    "  throw NotImplemented(\"roots\", \"handouts/a9_x.md#hint\");\n}\n\ndouble speed(double) {\n  "
    "throw NotImplemented(\"speed\", \"handouts/a9_x.md#hint\");\n}\n\n}  // namespace "
    "tumble::a9\n";

TEST_F(ReleaseChecks, StubIsAccepted) {
  EXPECT_TRUE(what_is_no_stub("a9_x.cpp", kStub, {"roots", "speed"}).empty());
}

TEST_F(ReleaseChecks, StubThatAnswersOrHasMoreOrLacksAFunctionIsNamedWithItsLine) {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = kStub;
    return text.replace(text.find(from), from.size(), to);
  };
  const auto answers = what_is_no_stub(
      "s.cpp",
      changed("throw NotImplemented(\"speed\", \"handouts/a9_x.md#hint\");", "return 1.0;"),
      {"roots", "speed"});
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].where, "s.cpp:10");
  const auto before =
      what_is_no_stub("s.cpp",
                      changed("  throw NotImplemented(\"speed\"",
                              "  const double j = 2.0;\n  throw NotImplemented(\"speed\""),
                      {"roots", "speed"});
  ASSERT_EQ(before.size(), 1u);
  const auto helper = what_is_no_stub(
      "s.cpp", changed("double speed", "double secret() { return 2.0; }\n\ndouble speed"),
      {"roots", "speed"});
  ASSERT_EQ(helper.size(), 1u);
  EXPECT_EQ(helper[0].where, "s.cpp:10");
  EXPECT_EQ(what_is_no_stub("s.cpp", kStub, {"roots", "speed", "third"}).size(), 1u);
}

TEST_F(ReleaseChecks, NeededFileThatIsLeftOutIsNamedWithItsUser) {
  write("framework/core/CMakeLists.txt",
        "tumble_library(core\n  SOURCES error.cpp new_part.cpp)\n");
  write("framework/core/error.cpp", "#include \"framework/core/new_part.h\"\n");
  const auto found =
      missing_files(folder_.path(), {"framework/core/CMakeLists.txt", "framework/core/error.cpp"},
                    {"framework/core/new_part.cpp", "framework/core/new_part.h", "my_notes.txt"});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].where, "framework/core/CMakeLists.txt:2");
  EXPECT_EQ(found[1].where, "framework/core/error.cpp:1");
}

}  // namespace
}  // namespace tumble::grading
