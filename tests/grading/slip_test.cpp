// Slips: what is written, what it makes of its base, and what is said where the two do not fit.
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/course/slip.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBase =
    "// A right solution.\n"                    // 1
    "double norm(double x, double y) {\n"       // 2
    "  const double square = x * x + y * y;\n"  // 3
    "  if (square == 0) return 0.0;\n"          // 4
    "  return std::sqrt(square);\n"             // 5
    "}\n"                                       // 6
    "\n"                                        // 7
    "double sign(double x) {\n"                 // 8
    "  if (x == 0) return 0.0;\n"               // 9
    "  return x > 0 ? 1.0 : -1.0;\n"            // 10
    "}\n";                                      // 11

constexpr const char* kTitle =
    "// mutant: root_forgotten - the square is returned\n// caught-by: the root\n";

/// Solutions of an assignment a9_x, with a slip m/s.slip beside them.
class SlipFile : public ::testing::Test {
 protected:
  SlipFile() {
    write_whole(solutions / "a9_x.cpp", kBase);
    write_whole(solutions / "alternatives/by_parts.cpp",
                "double norm(double x, double y) { return std::hypot(x, y); }\n");
  }
  MadeSolution made_of(const std::string& blocks,
                       const std::string& base = "// base: reference\n") const {
    write_whole(file, kTitle + base + blocks);
    return make_solution(file, solutions);
  }
  /// What is said against these blocks; fails the test where nothing is.
  std::string refusal_of(const std::string& blocks,
                         const std::string& base = "// base: reference\n") const {
    try {
      made_of(blocks, base);
    } catch (const UserError& error) {
      return error.what();
    }
    ADD_FAILURE() << "was taken:\n" << blocks;
    return "";
  }
  std::string at_line(int line) const { return file.string() + ":" + std::to_string(line) + ": "; }
  std::string base_at(int line) const {
    return (solutions / "a9_x.cpp").string() + ":" + std::to_string(line);
  }

  PrivateFolder folder;
  fs::path solutions = folder.path() / "a9_x", file = folder.path() / "m/s.slip";
};

std::string changed(const std::string& from, const std::string& to, std::string text = kBase) {
  return text.replace(text.find(from), from.size(), to);
}

void expect_holds(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is missing in: " << text;
}

TEST_F(SlipFile, ChangesWhatItsBlocksSayAndNothingElse) {
  const MadeSolution made = made_of(
      "@@ norm\n-  return std::sqrt(square);\n+  const double root = square;\n+  return root;\n@@ "
      "sign\n-  if (x == 0) return 0.0;\n");
  EXPECT_EQ(made.text, changed("  if (x == 0) return 0.0;\n", "",
                               changed("  return std::sqrt(square);\n",
                                       "  const double root = square;\n  return root;\n")));
  EXPECT_EQ(made.taken_out, (std::set<int>{5, 9}));
  ASSERT_EQ(made.origins.size(), 11u);
  EXPECT_FALSE(made.origins[3].is_of_slip);
  EXPECT_EQ(made.origins[3].line, 4);
  EXPECT_TRUE(made.origins[5].is_of_slip);
  EXPECT_EQ(made.origins[5].line, 7);
  EXPECT_FALSE(made.origins[9].is_of_slip);
  EXPECT_EQ(made.origins[9].line, 10);
}

TEST_F(SlipFile, SaysItsNameItsSlipAndWhatCatchesIt) {
  made_of("@@\n-  return std::sqrt(square);\n+  return square;\n");
  const SlipTitle title = read_slip(file).title;
  EXPECT_EQ(title.name, "root_forgotten");
  EXPECT_EQ(title.slip, "the square is returned");
  EXPECT_EQ(title.keyword, "the root");
}

TEST_F(SlipFile, PutsLinesBehindAKeptOne) {
  const MadeSolution made =
      made_of("@@\n   const double square = x * x + y * y;\n+  if (square < 1e-6) return 0.0;\n");
  EXPECT_EQ(made.text, changed("y * y;\n", "y * y;\n  if (square < 1e-6) return 0.0;\n"));
  EXPECT_TRUE(made.taken_out.empty());
}

TEST_F(SlipFile, BlocksMayStandInAnyOrder) {
  const std::string first = "@@\n-  return std::sqrt(square);\n+  return square;\n",
                    second = "@@\n-  return x > 0 ? 1.0 : -1.0;\n+  return 1.0;\n";
  EXPECT_EQ(made_of(first + second).text, made_of(second + first).text);
}

TEST_F(SlipFile, ChangesAnAlternativeByItsName) {
  const MadeSolution made = made_of(
      "@@\n-double norm(double x, double y) { return std::hypot(x, y); }\n+double norm(double x, "
      "double y) { return x + y; }\n",
      "// base: by_parts\n");
  EXPECT_EQ(made.text, "double norm(double x, double y) { return x + y; }\n");
  EXPECT_EQ(made.base, solutions / "alternatives/by_parts.cpp");
}

TEST_F(SlipFile, AnUnknownBaseIsAnsweredWithTheNearest) {
  expect_holds(
      refusal_of("@@\n-a\n", "// base: by_part\n"),
      {at_line(3), "'by_part'", "Did you mean 'by_parts'?", "Known: reference, by_parts."});
  expect_holds(refusal_of("@@\n-a\n", ""), {at_line(3), "does not name the right solution"});
}

// Line ends of Windows, in the slip, in the base or in both, are no difference.
TEST_F(SlipFile, LineEndsOfWindowsAreLineEnds) {
  const auto windows = [](const std::string& text) {
    std::string with_returns;
    for (const char c : text) with_returns += c == '\n' ? std::string("\r\n") : std::string(1, c);
    return with_returns;
  };
  const std::string slip = std::string(kTitle) +
                           "// base: reference\n@@\n   if (square == 0) return 0.0;\n-  return "
                           "std::sqrt(square);\n+  return square;\n";
  const std::string expected = changed("std::sqrt(square)", "square");
  write_whole(file, windows(slip));
  EXPECT_EQ(make_solution(file, solutions).text, expected);
  EXPECT_EQ(read_slip(file).title.keyword, "the root");
  write_whole(solutions / "a9_x.cpp", windows(kBase));
  EXPECT_EQ(make_solution(file, solutions).text, expected);
  write_whole(file, slip);
  EXPECT_EQ(make_solution(file, solutions).text, expected);
}

TEST_F(SlipFile, TheLastLineNeedsNoEnd) {
  write_whole(solutions / "a9_x.cpp", "int one() { return 1; }\nint two() { return 2; }");
  EXPECT_EQ(made_of("@@\n-int two() { return 2; }\n+int two() { return 3; }").text,
            "int one() { return 1; }\nint two() { return 3; }\n");
}

// What diff -U1 prints may be pasted: numbers of lines behind @@, and its remark on a missing line
// end.
TEST_F(SlipFile, ReadsWhatDiffPrints) {
  const MadeSolution made = made_of(
      "@@ -9,3 +9,3 @@ double sign(double x) {\n   if (x == 0) return 0.0;\n-  return x > 0 ? 1.0 "
      ": -1.0;\n+  return x > 0 ? 1.0 : 0.0;\n }\n\\ No newline at end of file\n");
  EXPECT_EQ(made.text, changed("-1.0", "0.0"));
}

// Only the first column is a mark: code may begin with any of them.
TEST_F(SlipFile, CodeMayLookLikeMarks) {
  write_whole(solutions / "a9_x.cpp",
              "const char* kSlip = R\"(// base: reference\n@@ f\n-old\n+new\n--i;\n)\";\n");
  EXPECT_EQ(made_of("@@ f\n @@ f\n--old\n-+new\n++new\n++@@\n --i;\n").text,
            "const char* kSlip = R\"(// base: reference\n@@ f\n+new\n+@@\n--i;\n)\";\n");
}

TEST_F(SlipFile, EmptyLinesStandForThemselvesWithinABlockAndForNothingBehindIt) {
  const MadeSolution made = made_of(
      "// A remark.\n\n@@\n }\n\n-double sign(double x) {\n+double sign(float x) {\n\n\n@@\n-  "
      "return std::sqrt(square);\n+  return square;\n\n");
  EXPECT_EQ(made.text, changed("double sign(double x)", "double sign(float x)",
                               changed("std::sqrt(square)", "square")));
}

TEST_F(SlipFile, AChangedBaseIsNamedWithTheLineThatIsGoneAndTheNearest) {
  write_whole(solutions / "a9_x.cpp", changed("std::sqrt(square)", "std::sqrt(squared)"));
  expect_holds(
      refusal_of(
          "@@\n   if (square == 0) return 0.0;\n-  return std::sqrt(square);\n+  return square;\n"),
      {at_line(6),
       "stands nowhere in " + (solutions / "a9_x.cpp").string() + ": 'return std::sqrt(square);'",
       "the nearest is line 5: 'return std::sqrt(squared);'", "write the slip again"});
}

TEST_F(SlipFile, LinesThatDoNotStandTogetherAreNoMatch) {
  expect_holds(
      refusal_of("@@\n   const double square = x * x + y * y;\n-  return std::sqrt(square);\n"),
      {at_line(4), "nowhere do they stand one below the other", "write the slip again"});
}

TEST_F(SlipFile, SpacesCount) {
  expect_holds(refusal_of("@@\n-\treturn std::sqrt(square);\n"), {at_line(5), "stands nowhere in"});
}

TEST_F(SlipFile, TextThatStandsTwiceIsNamedWithBothPlaces) {
  write_whole(solutions / "a9_x.cpp",
              std::string(kBase) + "double cosign(double x) {\n  if (x == 0) return 0.0;\n");
  expect_holds(
      refusal_of("@@\n-  if (x == 0) return 0.0;\n"),
      {at_line(4), "more than once, at " + base_at(9) + " and " + base_at(13), "Add kept lines"});
  EXPECT_EQ(made_of("@@\n double sign(double x) {\n-  if (x == 0) return 0.0;\n").taken_out,
            (std::set<int>{9}));
}

TEST_F(SlipFile, BlocksThatShareALineAreOne) {
  expect_holds(
      refusal_of("@@\n   if (square == 0) return 0.0;\n-  return std::sqrt(square);\n@@\n-  const "
                 "double square = x * x + y * y;\n   if (square == 0) return 0.0;\n"),
      {at_line(4), "shares " + base_at(4) + " with the block at line 7",
       "Make one block of the two"});
}

TEST_F(SlipFile, WhatChangesNothingIsRefused) {
  expect_holds(refusal_of(""), {"changes nothing: it holds no block"});
  expect_holds(refusal_of("@@\n@@\n-  return std::sqrt(square);\n"),
               {at_line(4), "a block that changes nothing"});
  expect_holds(refusal_of("@@\n   return std::sqrt(square);\n"),
               {at_line(4), "a block that changes nothing"});
}

TEST_F(SlipFile, ABlockOfNewLinesAloneHasNoPlace) {
  expect_holds(refusal_of("@@\n+  return 0.0;\n"),
               {at_line(4), "does not say where its lines belong"});
}

TEST_F(SlipFile, ALineWithoutAMarkIsNamed) {
  expect_holds(refusal_of("@@\n-  return std::sqrt(square);\nreturn square;\n"),
               {at_line(6), "has no mark in its first column: 'return square;'"});
  expect_holds(refusal_of("-  return std::sqrt(square);\n@@\n"),
               {at_line(4), "stands before the first block"});
}

TEST_F(SlipFile, ATitleIsNeeded) {
  write_whole(file, "// base: reference\n@@\n-  return std::sqrt(square);\n");
  EXPECT_THROW(read_slip(file), UserError);
  EXPECT_THROW(read_slip_title(file), UserError);
  EXPECT_THROW(read_slip(folder.path() / "none.slip"), UserError);
}

// The compiler read s.cpp. Its line 5 is the slip's line 5, its line 6 the base's line 6, which
// stood there before.
TEST_F(SlipFile, CompilerErrorsAreToldInPlacesOfTheSlipAndItsBase) {
  const MadeSolution made =
      made_of("@@\n-  return std::sqrt(square);\n+  return std::sqrt(sqare);\n+  retrun 0.0;\n");
  const std::string story =
      "s.cpp:5:20: error: 'sqare' was not declared\n    5 |   return std::sqrt(sqare);\n      |    "
      "                ^~~~~\n"
      "s.cpp:8:1: error: required from here\n    8 | \n"
      "Eigen/Core.h:5:1: error: static assertion failed\n    5 | #error\n"
      "s.cpp: error: sign is missing\n";
  EXPECT_EQ(in_places_of_slip(story, "s.cpp", made),
            "s.slip:6:20: error: 'sqare' was not declared\n    6 |   return std::sqrt(sqare);\n    "
            "  |                    ^~~~~\n"
            "a9_x.cpp:7:1: error: required from here\n    7 | \n"
            "Eigen/Core.h:5:1: error: static assertion failed\n    5 | #error\n"
            "s.slip: error: sign is missing\n");
}

// A solution that was mended, and a slip that it left behind, are seen here rather than in the next
// audit.
TEST(SlipsOfTheTree, FitTheirBases) {
  const fs::path solutions = fs::path(test::source_dir()) / "solutions_private";
  if (!fs::exists(solutions)) GTEST_SKIP() << "the solutions are not here";
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(solutions)) {
    if (entry.path().extension() != kSlipExtension) continue;
    ++count;
    EXPECT_EQ(entry.path().stem(), read_slip(entry.path()).title.name);
    EXPECT_NO_THROW(make_solution(entry.path(), entry.path().parent_path().parent_path()))
        << entry.path();
  }
  EXPECT_GE(count, 16);
}

}  // namespace
}  // namespace tumble::grading
