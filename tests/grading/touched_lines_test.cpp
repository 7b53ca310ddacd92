// Which lines of a reference count, and which of them slips touch.
#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/grading/grades/touched_lines.h"

namespace tumble::grading {
namespace {

constexpr const char* kReference =
    "// Reference.\n"                      // 1
    "#include <cmath>\n"                   // 2
    "\n"                                   // 3
    "namespace tumble::a9 {\n"             // 4
    "class Sum {\n"                        // 5  code
    " public:\n"                           // 6
    "  /* of two\n"                        // 7
    "     numbers */\n"                    // 8
    "  double of(double a) const {\n"      // 9  code
    "    // halves\n"                      // 10
    "    const double half = a / 2;\n"     // 11 code
    "    return half + half_;\n"           // 12 code
    "  }\n"                                // 13
    "\n"                                   // 14
    "  double half_ = 0;  // the other\n"  // 15 code
    "};\n"                                 // 16
    "}  // namespace tumble::a9\n";        // 17

TEST(TouchedLines, CommentsIncludesNamespacesLabelsAndBracesAreNoCode) {
  const TouchedLines lines = touched_lines("reference.cpp", kReference, {});
  EXPECT_EQ(lines.code_lines, 5);
  EXPECT_EQ(lines.touched, 0);
  ASSERT_EQ(lines.untouched.size(), 1u);
  EXPECT_EQ(lines.untouched[0].first, 5);
  EXPECT_EQ(lines.untouched[0].last, 15);
  EXPECT_EQ(lines.untouched[0].code_lines, 5);
}

TEST(TouchedLines, ARangeEndsWhereASlipTouches) {
  const TouchedLines lines = touched_lines("reference.cpp", kReference, {10, 11, 16});
  EXPECT_EQ(lines.touched, 1);  // a comment and a brace are no code, whoever takes them out
  ASSERT_EQ(lines.untouched.size(), 2u);
  EXPECT_EQ(lines.untouched[0].first, 5);
  EXPECT_EQ(lines.untouched[0].last, 9);
  EXPECT_EQ(lines.untouched[0].text, "class Sum {");
  EXPECT_EQ(lines.untouched[1].first, 12);
  EXPECT_EQ(lines.untouched[1].last, 15);
  EXPECT_EQ(lines.untouched[1].code_lines, 2);
}

class TouchedLinesOfReference : public ::testing::Test {
 protected:
  TouchedLinesOfReference() {
    register_assignments(registry);
    write("a1_impulse.cpp", "int one() {\n  return 1;\n}\nint two() {\n  return 2;\n}\n");
    write("alternatives/other.cpp",
          "int one() {\n  return 1;\n}\nint two() {\n  return 3 - 1;\n}\n");
    slip("first", "reference", "-  return 1;\n+  return 0;\n");
    slip("second", "other", "-  return 3 - 1;\n+  return 3 + 1;\n");
    slip("third", "reference", " int two() {\n+  if (one() == 0) return 0;\n");
  }
  void write(const std::string& file, const std::string& text) const {
    write_whole(folder.path() / "solutions_private/a1_impulse" / file, text);
  }
  void slip(const std::string& name, const std::string& base, const std::string& block) const {
    write("mutants/" + name + ".slip",
          "// mutant: " + name + " - n\n// caught-by: w\n// base: " + base + "\n@@\n" + block);
  }
  PrivateFolder folder;
  modules::Registry registry;
  Course course{folder.path(), folder.path() / "build", &registry, ""};
};

// Slips of other right solutions touch those, and a line put in between touches none.
TEST_F(TouchedLinesOfReference, AreThoseThatItsOwnSlipsTakeOut) {
  const TouchedLines lines =
      touched_lines_of_reference(course, "a1", find_candidates(course, "a1"));
  EXPECT_EQ(lines.code_lines, 4);
  EXPECT_EQ(lines.touched, 1);
  EXPECT_EQ(lines.file, reference_of(course, "a1"));
}

// A mended base leaves many slips behind: all are named at once, and those that still fit can be
// judged alone.
TEST_F(TouchedLinesOfReference, EverySlipThatNoLongerFitsIsNamed) {
  write("a1_impulse.cpp", "int one() {\n  return 4 - 3;\n}\n");
  const std::vector<Candidate> all = find_candidates(course, "a1");
  try {
    sources_of(all);
    FAIL() << "slips that do not fit were taken";
  } catch (const UserError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("2 known-wrong solutions cannot be judged"), std::string::npos) << said;
    EXPECT_NE(said.find("first.slip:5: "), std::string::npos) << said;
    EXPECT_NE(said.find("third.slip:5: "), std::string::npos) << said;
    EXPECT_EQ(said.find("second.slip"), std::string::npos) << said;
  }
  EXPECT_EQ(sources_of(only(all, {"second"})).front().text,
            "int one() {\n  return 1;\n}\nint two() {\n  return 3 + 1;\n}\n");
}

}  // namespace
}  // namespace tumble::grading
