// A story taken apart for a page: named values, terms, arms.
#include <gtest/gtest.h>

#include "framework/grading/grades/story_section.h"

namespace tumble::grading {
namespace {

// As a terminal shows it (tests/support/story.cpp, framework/grading/verdicts/xray.cpp).
constexpr const char* kStory = R"(
  scene:    a block, turned by 120 degrees
  expected: 4 N s
  found:    6 N s
  read:     handouts/a1_impulse.md#eq-a1-9
  x-ray:    j = -(1 + e) u_n / k   (A1.9)
            r_a                       (1, 0, -1) m
            k_a                       1 1/kg   <- what was found comes out with I^-1 of the body
            r_b                       (6, 3, 0) m
            n                         (0, 0, 1)
            j                         4 N s expected, 6 N s found)";

TEST(Story, IsTakenApart) {
  const StoryParts parts = parts_of_story(kStory);
  EXPECT_EQ(parts.before, "");
  ASSERT_EQ(parts.fields.size(), 4u);
  EXPECT_EQ(parts.fields[2].name, "found");
  EXPECT_EQ(parts.fields[2].text, "6 N s");
  EXPECT_EQ(parts.equation, "j = -(1 + e) u_n / k   (A1.9)");
  ASSERT_EQ(parts.terms.size(), 5u);
  EXPECT_EQ(parts.terms[1].value, "1 1/kg");
  EXPECT_EQ(parts.terms[1].mark, "what was found comes out with I^-1 of the body");
  EXPECT_EQ(parts.terms[4].value, "4 N s expected, 6 N s found");
}

TEST(Story, KeepsLinesWithoutAName) {
  const StoryParts crash = parts_of_story("SIGSEGV, in f\n  called with: {1, 2}\nyours: 3");
  EXPECT_EQ(crash.before, "SIGSEGV, in f\n");
  ASSERT_EQ(crash.fields.size(), 1u);
  EXPECT_EQ(crash.fields[0].text, "{1, 2}\nyours: 3");
  EXPECT_EQ(parts_of_story("no answer within 2 s").before, "no answer within 2 s\n");
}

TEST(Story, ItsArmsAreDrawn) {
  const auto arms = arms_of(parts_of_story(kStory).terms);
  ASSERT_TRUE(arms);
  ASSERT_EQ(arms->arms.size(), 2u);
  EXPECT_EQ(arms->arms[1].body, "B");
  EXPECT_EQ(arms->arms[1].arm_world, Eigen::Vector3d(6, 3, 0));
  EXPECT_FALSE(arms_of({{"r_a", "(1, 0, inf) m", ""}, {"n", "(0, 0, 1)", ""}}));
  EXPECT_FALSE(arms_of({{"r_a", "(1, 0, 0) m", ""}}));  // no direction
}

TEST(Story, IsTextInAPage) {
  report::Page page("T");
  add_story(page, "  found:    <b>6</b>, handouts/a1_impulse.md#eq-a1-9",
            {"../handout.html", "a1_impulse"});
  const std::string html = page.html();
  EXPECT_NE(
      html.find("<dt>found</dt><dd>&lt;b&gt;6&lt;/b&gt;, <a href=\"../handout.html#eq-a1-9\">"),
      std::string::npos)
      << html;
}

}  // namespace
}  // namespace tumble::grading
