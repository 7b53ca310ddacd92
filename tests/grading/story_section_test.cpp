// A story taken apart for a page: named values, terms, arms.
#include <algorithm>

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
            k_a                       1 1/kg   <- your answer comes out with I^-1 of the body
            r_b                       (6, 3, 0) m
            n                         (0, 0, 1)
            j, expected               4 N s
            j, found                  6 N s)";

TEST(Story, IsTakenApart) {
  const StoryParts parts = parts_of_story(kStory);
  EXPECT_EQ(parts.before, "");
  ASSERT_EQ(parts.fields.size(), 4u);
  EXPECT_EQ(parts.fields[2].name, "found");
  EXPECT_EQ(parts.fields[2].text, "6 N s");
  EXPECT_EQ(parts.equation, "j = -(1 + e) u_n / k   (A1.9)");
  ASSERT_EQ(parts.terms.size(), 6u);
  EXPECT_EQ(parts.terms[1].value, "1 1/kg");
  EXPECT_EQ(parts.terms[1].mark, "your answer comes out with I^-1 of the body");
  EXPECT_EQ(parts.terms[5].name, "j, found");
  EXPECT_EQ(parts.terms[5].value, "6 N s");
}

// A terminal pads numbers to stand below each other; in a table they are as elsewhere on the page.
TEST(Story, ItsRowsHaveNoBlanksThatAlignNumbers) {
  const StoryParts parts = parts_of_story(
      "  x-ray:    y = x\n            y, expected               (  3,   4, -10) m\n"
      "            y, found                  (-12, 0.5,   1) m   <- the first wrong line");
  ASSERT_EQ(parts.terms.size(), 2u);
  EXPECT_EQ(parts.terms[0].value, "(3, 4, -10) m");
  EXPECT_EQ(parts.terms[1].value, "(-12, 0.5, 1) m");
  EXPECT_EQ(parts.terms[1].mark, "the first wrong line");
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
  // a product of r is no arm: the function has one body
  const auto one = arms_of({{"r = p - x", "(1, 0, 0) m", ""},
                            {"J", "(0, 0, 1) N s", ""},
                            {"r x J", "(0, -1, 0) N m s", ""}});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->arms.size(), 1u);
}

// A story of three failures: each by itself, and the x-ray with the first, which it is of.
TEST(Story, EachSceneStandsByItself) {
  report::Page page("T");
  add_story(page,
            "  scene:    one\n  look at:  the sign\n  scene:    two\n  likely:   the factor\n"
            "  x-ray:    y = x\n            x                         1 m",
            {});
  const std::string html = page.html();
  const auto first = html.find("<h4>Case 1 of 2</h4>"), second = html.find("<h4>Case 2 of 2</h4>"),
             xray = html.find("<dt>x-ray</dt>");
  ASSERT_NE(first, std::string::npos) << html;
  EXPECT_LT(first, xray);
  EXPECT_LT(xray, second);
  // in the list of the story's fields, so that it begins where they begin
  EXPECT_LT(html.rfind("<dl", xray), html.find("<dt>scene</dt>"));
  // what is only to be looked at is no mistake that was seen
  EXPECT_NE(html.find("<dt>to check</dt><dd>the sign"), std::string::npos);
  EXPECT_NE(html.find("<dt>likely mistake</dt><dd>the factor"), std::string::npos);
}

// A row of many numbers does not make its table wider than the page.
TEST(Story, ALongTermIsBrokenIntoLines) {
  report::Page page("T");
  std::string numbers = "(0.5";
  for (int i = 1; i < 20; ++i) numbers += ", 0.692449";
  add_story(page, "  scene:    one\n  x-ray:    y = x\n            x   " + numbers + ") m", {});
  const std::string html = page.html();
  const std::size_t from = html.find("(0.5, "), end = html.find(") m", from);
  ASSERT_NE(from, std::string::npos) << html;
  for (std::size_t at = from; at < end;) {
    const std::size_t next = std::min(html.find('\n', at), end);
    EXPECT_LE(next - at, 64u) << html.substr(at, next - at);
    at = next + 1;
  }
}

// "mistake: what is right" is one line in a terminal; in a page what is right stands apart.
TEST(Story, TellsMistakeAndCureApart) {
  report::Page page("T");
  add_story(page, "  found:    (3, 4)\n  likely:   normal not unit: divide by its length", {});
  EXPECT_NE(page.html().find("<dt>likely mistake</dt><dd>normal not unit</dd>\n"
                             "<dt>remember</dt><dd>divide by its length</dd>"),
            std::string::npos)
      << page.html();
}

// "(3, 4) (unit)" would call a vector of length 5 a unit vector.
TEST(Story, CallsOnlyTheExpectedDirectionAUnitVector) {
  report::Page page("T");
  add_story(page, "  expected: (0.6, 0.8) (unit)\n  found:    (3, 4) (unit)", {});
  EXPECT_NE(page.html().find("<dt>expected</dt><dd>(0.6, 0.8), of length 1</dd>\n"
                             "<dt>found</dt><dd>(3, 4)</dd>"),
            std::string::npos)
      << page.html();
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
