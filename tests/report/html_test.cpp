// Pages: names and output of submissions are text on them, never markup.
#include "framework/report/html.h"
#include "framework/report/html_text.h"

#include <gtest/gtest.h>

#include "framework/core/error.h"

namespace tumble::report {
namespace {

TEST(HtmlEscape, MarkupBecomesText) {
  EXPECT_EQ(html_escape("<script>alert('x')</script> & \"y\""),
            "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &amp; &quot;y&quot;");
}

TEST(HtmlEscape, TerminalCodesAndControlsAreDropped) {
  EXPECT_EQ(html_escape("\x1b[31mred\x1b[0m\a\tand\nnew line"), "red\tand\nnew line");
}

TEST(HtmlEscape, CharactersThatReverseTheWritingAreDropped) {
  // U+202E turns the rest of a line around: "exe.txt" would read "txt.exe".
  EXPECT_EQ(html_escape("a\u202eb\u2066c\u200bd"), "abcd");
}

TEST(HtmlEscape, BytesThatAreNotTextAreReplaced) {
  EXPECT_EQ(html_escape("a\xff"
                        "b\xc0\xaf"),
            "a\xef\xbf\xbd"
            "b\xef\xbf\xbd\xef\xbf\xbd");
  EXPECT_EQ(html_escape("gr\u00fc\u00df \u4f60\u597d"), "gr\u00fc\u00df \u4f60\u597d");
}

TEST(Link, OddBytesAreWrittenAsHex) {
  EXPECT_EQ(link_to("a b/#1?<x>.html"), "a%20b/%231%3F%3Cx%3E.html");
}

TEST(Page, RefusesALinkWithAScheme) {
  Page page("t");
  EXPECT_THROW(page.table({"", {{"a"}}, {{{"x", "javascript:alert(1)"}}}}), PreconditionError);
}

TEST(Page, EveryPlaceForTextEscapesIt) {
  const std::string evil = "<img src=x onerror=alert(1)>\"'";
  Page page(evil, evil);
  page.heading(evil);
  page.paragraph(evil);
  page.preformatted(evil);
  page.fold(evil, evil);
  page.table({evil, {{evil}}, {{{evil}}}});
  page.tiles({{evil, {evil}}});
  page.figures({{"a.png", "a.mp4", evil, evil}});
  page.links({{evil, "#x"}});
  page.record(evil);
  EXPECT_EQ(page.html().find("<img src=x"), std::string::npos);
  EXPECT_EQ(page.html().find("onerror=alert(1)>"), std::string::npos);
}

TEST(Page, TablesOfSentencesAreBlocksOnAPhone) {
  Page page("t");
  const std::string sentence = "a sentence that is longer than a phone's line";
  page.table({"", {{"A"}, {"B"}, {"C"}}, {{{"x", "", Look::kPlain, "row-x"}, {"y"}, {sentence}}}});
  const std::string html = page.html();
  EXPECT_NE(html.find("<table class=\"blocks\">"), std::string::npos);
  EXPECT_NE(html.find("<tr id=\"row-x\"><td data-name=\"A\">x</td>"), std::string::npos) << html;
  EXPECT_NE(html.find(".blocks td { display: block; }"), std::string::npos);
  Page numbers("t");
  numbers.table({"", {{"A"}, {"B"}, {"C"}}, {{{"1"}, {"2"}, {"3"}}}});
  EXPECT_EQ(numbers.html().find("class=\"blocks\""), std::string::npos);
}

TEST(Page, CodeKeepsItsIndents) {
  Page page("t");
  page.code("  if (a < b)");
  EXPECT_NE(page.html().find("<pre class=\"code\" tabindex=\"0\">  if (a &lt; b)</pre>"),
            std::string::npos);
  EXPECT_NE(page.html().find("pre.code { white-space: pre;"), std::string::npos);
}

TEST(Page, ForbidsScriptsAndTheNetwork) {
  const std::string html = Page("t").html();
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("http:"), std::string::npos);
  EXPECT_EQ(html.find("https:"), std::string::npos);
}

TEST(Page, APartHoldsWhatFollowsUntilItsEnd) {
  Page page("T");
  page.begin(Part::kFold, "two <rows>");
  page.paragraph("inside");
  EXPECT_THROW(page.html(), PreconditionError);  // it has no end
  page.end();
  EXPECT_NE(page.html().find("<summary>two &lt;rows&gt;</summary>\n<p>inside</p>\n</details>"),
            std::string::npos);
  EXPECT_THROW(page.end(), PreconditionError);
}

TEST(Page, PreformattedTextLeadsWhereItsLinksDo) {
  Page page("T");
  page.preformatted("read: a.md#x & a.md", {{"a.md#x", "a.html#x"}});
  EXPECT_NE(page.html().find("<pre>read: <a href=\"a.html#x\">a.md#x</a> &amp; a.md</pre>"),
            std::string::npos);
}

TEST(Page, FieldsAreTextUnderTheirNames) {
  Page page("T");
  page.fields({{"found", "<6>"}, {"read", "see a.md#x", {{"a.md#x", "a.html#x"}}}});
  EXPECT_NE(page.html().find("<dt>found</dt><dd>&lt;6&gt;</dd>"), std::string::npos);
  EXPECT_NE(page.html().find("<dd>see <a href=\"a.html#x\">a.md#x</a></dd>"), std::string::npos);
}

TEST(Page, ATableWithoutNamesHasNoHead) {
  Page page("T");
  page.table({"", {{""}, {""}}, {{{"u"}, {"-3 m/s"}}}});
  EXPECT_EQ(page.html().find("<thead>"), std::string::npos);
}

// Controls of a video would cover a small picture.
TEST(Page, AThumbnailIsAPictureThatLeads) {
  Page page("T");
  page.thumbnails({{"a.png", "a.mp4", "A fall", "", "a.html"}});
  const std::string html = page.html();
  EXPECT_NE(html.find("href=\"a.html\"><img loading=\"lazy\" src=\"a.png\""), std::string::npos);
  EXPECT_EQ(html.find("<video"), std::string::npos);
}

// A chart's hatching is found by its id: on a page each chart has ids of its own.
TEST(Page, TwoChartsShareNoId) {
  Page page("T");
  const StackedBars bars{
      .title = "t", .axis = {"n"}, .parts = {"a", "b", "c"}, .rows = {{"row", {1.0, 1.0, 1.0}}}};
  page.plot(bars);
  page.plot(bars);
  const std::string html = page.html();
  for (const std::string number : {"1", "2"}) {
    const std::size_t at = html.find("<pattern id=\"bar" + number + "-2\"");
    ASSERT_NE(at, std::string::npos) << html;
    EXPECT_EQ(html.find("<pattern id=\"bar" + number + "-2\"", at + 1), std::string::npos);
    EXPECT_NE(html.find("url(#bar" + number + "-2)"), std::string::npos);
  }
}

// The picture stands in the flow and gives the height; the controls have room below it.
TEST(Page, AVideoHasRoomForItsControlsBelowThePicture) {
  Page page("T");
  page.figures({{"a.png", "a.mp4", "A fall", "", ""}});
  const std::string html = page.html();
  EXPECT_NE(html.find("<div class=\"film\"><video "), std::string::npos) << html;
  EXPECT_NE(html.find(".film { position: relative;"), std::string::npos);
  EXPECT_NE(html.find("alt=\"A fall\"></div>"), std::string::npos);
}

// Letters of a wide drawing would have 7 px on a phone: it has a narrow drawing beside it, and the
// style of the page shows one of them. None scrolls, and none is a stop of the keyboard.
TEST(Page, AWidePlotHasANarrowOneBesideItAndASmallOneFits) {
  Page page("T");
  Plot wide;
  wide.title = "wide";
  page.plot(wide);
  StackedBars bars{.title = "bars", .axis = {"n"}, .parts = {"one"}, .rows = {{"a", {1.0}}}};
  page.plot(bars);
  bars.is_small = true;
  page.plot(bars);
  const std::string html = page.html();
  std::size_t narrow = 0;
  const std::string kNarrow = "</svg>\n<svg class=\"plot narrow\" viewBox=\"0 0 340 ";
  for (auto at = html.find(kNarrow); at != html.npos; at = html.find(kNarrow, at + 1)) ++narrow;
  EXPECT_EQ(narrow, 2u);
  EXPECT_NE(html.find("<figure class=\"plot-figure both\"><svg class=\"plot\" viewBox=\"0 0 640 "),
            std::string::npos);
  EXPECT_NE(html.find("<figure class=\"plot-figure small\"><svg class=\"plot\" viewBox=\"0 0 360 "),
            std::string::npos);
  EXPECT_EQ(html.find("<figure class=\"plot-figure\" tabindex"), std::string::npos);
  EXPECT_NE(html.find("svg.plot.narrow { display: none; }"), std::string::npos);
  EXPECT_NE(html.find(".both > svg.plot:not(.narrow) { display: none; }"), std::string::npos);
}

// A browser may break a line after any hyphen, so that 9.4e-15 would read 9.4e and -15.
TEST(Page, ANumberWithAnExponentIsKeptTogetherInASentence) {
  Page page("T");
  page.paragraph("off by 9.4e-15 m, <a1> one-2");
  const std::string html = page.html();
  EXPECT_NE(html.find("off by <span class=\"unbroken\">9.4e-15</span> m, &lt;a1&gt; one-2"),
            std::string::npos);
  EXPECT_NE(html.find(".unbroken { white-space: nowrap; }"), std::string::npos);
  Page story("T");
  story.fields({{"off by", "2 N s (allowed 3e-14 N s)"}});
  EXPECT_NE(story.html().find("<span class=\"unbroken\">3e-14</span> N s"), std::string::npos);
}

// Between its parts a formula may be broken: before "+ b", not behind the sign, and not in "(I w)".
TEST(Page, AFormulaBreaksBetweenItsParts) {
  EXPECT_EQ(formula_in_parts("a = tau - w x (I w) (A1.4)"),
            "a =\u00a0tau \u2212\u00a0w x\u00a0(I\u00a0w) (A1.4)");
  EXPECT_EQ(formula_in_parts("v' = v - (I^-1 J)"), "v' =\u00a0v \u2212\u00a0(I^-1\u00a0J)");
  EXPECT_EQ(formula_in_parts("(a + [ b c ] + d)"), "(a +\u00a0[\u00a0b\u00a0c\u00a0] +\u00a0d)");
  const std::string of_long_brackets = "(a word and another word of it)";
  EXPECT_EQ(formula_in_parts(of_long_brackets), of_long_brackets);
}

TEST(Page, ALongNameBreaksBehindAnUnderscoreInAHeading) {
  Page page("T");
  page.heading("In collision_impulse_without_rotation: e, in rk4_step too", 3);
  EXPECT_NE(page.html().find("<h3>In collision_<wbr>impulse_<wbr>without_<wbr>rotation: e, in "
                             "rk4_step too</h3>"),
            std::string::npos);
}

}  // namespace
}  // namespace tumble::report
