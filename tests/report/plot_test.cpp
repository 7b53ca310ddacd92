// Plots: ticks are round numbers, undrawable points break a line, text is escaped, limits are
// drawn.
#include <algorithm>
#include <cmath>

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/report/html.h"
#include "framework/report/plot.h"
#include "framework/report/stacked_bars.h"
#include "framework/report/ticks.h"

namespace tumble::testing {
namespace {

using namespace report;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Ticks, AreRoundNumbersWithinTheAxis) {
  EXPECT_EQ(ticks_of(0.0, 10.0, Scale::kLinear), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(ticks_of(1.0, 1e6, Scale::kLog), (std::vector<double>{1, 10, 100, 1e3, 1e4, 1e5, 1e6}));
  for (const double size : {1e-9, 0.3, 7.0, 1e12})
    for (const double low : {-0.7, 0.0, 3.0}) {
      const auto ticks = ticks_of(low * size, (low + 1) * size, Scale::kLinear);
      EXPECT_GE(ticks.size(), 4u) << size;
      EXPECT_LE(ticks.size(), 9u) << size;
      EXPECT_GE(ticks.front(), (low - 1e-6) * size);
      EXPECT_LE(ticks.back(), (low + 1 + 1e-6) * size);
    }
  EXPECT_LE(ticks_of(1e-17, 1e3, Scale::kLog).size(), 8u);
  // fewer than three numbers do not tell that an axis is logarithmic
  for (const double low : {0.9, 2.0, 4.7})
    for (const double times : {20.0, 50.0, 300.0})
      EXPECT_GE(ticks_of(low, low * times, Scale::kLog).size(), 3u) << low << ", " << times;
}

TEST(Ticks, OfAnAxisWithoutLengthBreakAPrecondition) {
  EXPECT_THROW(ticks_of(1.0, 1.0, Scale::kLinear), PreconditionError);
  EXPECT_THROW(ticks_of(0.0, 1.0, Scale::kLog), PreconditionError);
}

// The numbers of an axis are all plain or all powers of ten.
TEST(Ticks, HaveOneStyleAnAxis) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(tick_words({5000, 1e4, 2e4, 5e4}, Scale::kLog), (Words{"5e3", "1e4", "2e4", "5e4"}));
  EXPECT_EQ(tick_words({1, 100, 1e4, 1e6}, Scale::kLog), (Words{"1e0", "1e2", "1e4", "1e6"}));
  EXPECT_EQ(tick_words({1e-4, 1e-2, 1}, Scale::kLog), (Words{"1e-4", "1e-2", "1e0"}));
  EXPECT_EQ(tick_words({0.01, 0.1, 1, 10}, Scale::kLog), (Words{"0.01", "0.1", "1", "10"}));
  EXPECT_EQ(tick_words({0, 5e-5, 1e-4, 1.5e-4}, Scale::kLinear),
            (Words{"0", "0.5e-4", "1e-4", "1.5e-4"}));
  EXPECT_EQ(tick_words({0, 5e5, 1e6}, Scale::kLinear), (Words{"0", "0.5e6", "1e6"}));
  // 0.1 - 0.1 as rounding leaves it
  EXPECT_EQ(tick_words({-0.2, -0.1, -1.4e-17, 0.1}, Scale::kLinear),
            (Words{"-0.2", "-0.1", "0", "0.1"}));
}

TEST(Lines, AreBrokenAtBlanksAndHoldAllWords) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(wrapped("one two three", 7), (Words{"one two", "three"}));
  EXPECT_EQ(wrapped("one", 2), (Words{"one"}));
  EXPECT_EQ(wrapped("reference rk4", 4), (Words{"reference", "rk4"}));
  EXPECT_EQ(wrapped("", 5), (Words{""}));
}

/// The rightmost end of a drawing's words, where a letter is as wide as 0.62 of its size; words
/// that are turned are left out.
double right_end_of_words(const std::string& svg) {
  double end = 0.0;
  for (std::size_t at = svg.find("<text x="); at != svg.npos; at = svg.find("<text x=", at + 1)) {
    const std::string element = svg.substr(at, svg.find("</text>", at) - at);
    if (element.find("rotate") != element.npos) continue;
    const double x = std::stod(element.substr(9)),
                 letter = 0.62 * (element.find("bold") == element.npos ? 11.5 : 13.5),
                 width = letter * static_cast<double>(element.size() - element.find('>') - 1);
    end = std::max(end, element.find("\"start\"") != element.npos    ? x + width
                        : element.find("\"middle\"") != element.npos ? x + 0.5 * width
                                                                     : x);
  }
  return end;
}

// A phone shows 360 px: what is drawn in 340 units has letters of 11 px there.
TEST(Plots, OfAPhoneHoldAllWordsInLettersOfFullSize) {
  Plot plot{"What accuracy costs: the largest error of all bodies over work",
            {"evaluations of the derivative of the state of all bodies", ""},
            {"largest error of a body over all samples of the run", "m", Scale::kLog},
            {{"reference rk4_step, with a step of 1/240 s and halvings of it", {1, 2}, {1e-9, 1e3}},
             {"a curve of the same values, which covers the first one", {1, 2}, {1e-9, 1e3}}},
            {}};
  const std::string svg = narrow_svg_of(plot);
  EXPECT_NE(svg.find("viewBox=\"0 0 340 "), std::string::npos);
  EXPECT_LE(right_end_of_words(svg), 340.0) << svg;
  EXPECT_EQ(count(svg, "font-size"), count(svg, "font-size=\"13.5\"")) << "none is made smaller";
  EXPECT_EQ(count(svg_of(plot), "font-size"), count(svg_of(plot), "font-size=\"13.5\""));
  const StackedBars bars{"Where the time of a run went, in parts",
                         {"share", "%"},
                         {"detect", "integrate"},
                         {{"Runge-Kutta, a step of 1/60 s", {30, 70}}}};
  EXPECT_LE(right_end_of_words(narrow_svg_of(bars)), 340.0);
}

TEST(Plots, BreakALineAtUndrawablePoints) {
  Plot plot{"t",
            {"x"},
            {"y", "m", Scale::kLog},
            {{"curve", {1, 2, 3, 4, 5}, {1.0, 2.0, std::nan(""), 0.0, 3.0}}},
            {}};
  const std::string svg = svg_of(plot);
  const std::string path = svg.substr(svg.find("<path d=\"M"));
  EXPECT_EQ(count(path.substr(0, path.find("fill")), "M"), 2u);  // two pieces
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(Plots, OfOneValueShowTheDecadesAroundIt) {
  Plot plot{"flat",
            {"time", "s"},
            {"error", "m", Scale::kLog},
            {{"a", {1, 2, 3}, {7e-15, 7e-15, 7e-15}}},
            {}};
  const std::string svg = svg_of(plot);
  EXPECT_EQ(count(svg, ">1e-15<"), 1u) << svg;
  EXPECT_EQ(count(svg, ">1e-14<"), 1u) << svg;
}

// Counts and shares are the most that a plot shows, and none is below 0: an axis from -1 to 1 would
// say that it might be.
TEST(Plots, OfZerosAloneBeginAtZero) {
  const Plot plot{
      "t", {"integrations"}, {"events not committed", "%"}, {{"a", {1, 2, 3}, {0, 0, 0}}}, {}};
  for (const std::string& svg : {svg_of(plot), narrow_svg_of(plot)}) {
    EXPECT_EQ(svg.find(">-"), std::string::npos) << svg;
    EXPECT_EQ(count(svg, ">0<"), 1u) << svg;
    EXPECT_EQ(count(svg, ">1<"), 2u) << svg;  // of both axes
  }
}

TEST(Plots, ATitleOfTwoLinesStandsAboveTheFrame) {
  Plot plot{"Chain of 100 links", {"x"}, {"y"}, {{"c", {0, 1}, {1, 2}}}, {}};
  const auto top_of_frame = [&] {
    const std::string svg = svg_of(plot), mark = "<rect x=\"78.0\" y=\"";
    return std::stod(svg.substr(svg.find(mark) + mark.size()));
  };
  const double of_one_line = top_of_frame();
  plot.title += ", hanging: how far its end is from where it belongs";
  EXPECT_GE(top_of_frame(), of_one_line + 13.5);  // the size of a title's letters
}

// A curve that ends at the limit's right end must stay visible: the name moves to the left.
TEST(Plots, NameALimitWhereItHidesNoCurve) {
  const auto place_of_name = [](std::vector<double> y) {
    const Plot plot{"t", {"x"}, {"y"}, {{"c", {0, 1, 2, 3}, std::move(y), true}}, {{1.0, "limit"}}};
    const std::string svg = svg_of(plot);
    return svg.substr(0, svg.find(">limit<"))
                   .ends_with("text-anchor=\"end\" fill=\"#a82c00\" class=\"halo\"")
               ? "right"
               : "left";
  };
  EXPECT_STREQ(place_of_name({1.05, 1.5, 2, 3}), "right");
  EXPECT_STREQ(place_of_name({3, 2, 1.5, 1.1}), "left");
}

// Curves at both ends, above the line and below it: the name stands in the legend, with a key.
TEST(Plots, NameALimitInTheLegendWhereItWouldHideCurvesEverywhere) {
  const Plot plot{"t",
                  {"x"},
                  {"y"},
                  {{"c", {0, 1, 2, 3}, {1.05, 1.05, 1.05, 1.05}, true},
                   {"d", {0, 1, 2, 3}, {0.95, 0.95, 0.95, 0.95}, true},
                   {"e", {0, 3}, {0, 2}}},
                  {{1.0, "limit"}}};
  for (const std::string& svg : {svg_of(plot), narrow_svg_of(plot)}) {
    EXPECT_EQ(count(svg, ">limit<"), 1u) << svg;
    EXPECT_EQ(svg.find("class=\"halo\""), std::string::npos) << svg;
    EXPECT_GT(svg.find(">limit<"), svg.find(">e<")) << svg;         // behind the curves' names
    EXPECT_EQ(count(svg, "stroke-dasharray=\"12 4\""), 2u) << svg;  // at its value, and in its key
  }
}

// Errors that come close to the error of their reference everywhere leave room only below its line.
// Numbers of a drawing grow downwards.
TEST(Plots, NameALimitUnderAllCurvesBelowItsLine) {
  const Plot plot{"t",
                  {"x"},
                  {"error", "m", Scale::kLog},
                  {{"c", {0, 1, 2, 3, 4}, {1e-14, 1e-14, 1e-2, 1e-14, 1e-14}, true}},
                  {{1e-15, "error of the reference"}}};
  for (const std::string& svg : {svg_of(plot), narrow_svg_of(plot)}) {
    const auto number_after = [&](std::size_t from, const std::string& mark) {
      return std::stod(svg.substr(svg.find(mark, from) + mark.size()));
    };
    const std::size_t name = svg.rfind("<text", svg.find(">error of the reference<"));
    const double line = number_after(svg.rfind("<line", name), " y1=\"");
    EXPECT_GT(number_after(name, " y=\""), line + 10) << svg;  // 10: the height of its letters
  }
}

TEST(Plots, WithoutPointsSaySo) {
  EXPECT_NE(svg_of(Plot{"t", {"x"}, {"y"}, {}, {}}).find("nothing to draw"), std::string::npos);
  EXPECT_NE(
      svg_of(Plot{"t", {"x"}, {"y"}, {{"c", {1.0}, {std::nan("")}}}, {}}).find("nothing to draw"),
      std::string::npos);
  // a horizontal line can be drawn
  EXPECT_EQ(
      svg_of(Plot{"t", {"x"}, {"y"}, {{"c", {1.0, 2.0}, {5.0, 5.0}}}, {}}).find("nothing to draw"),
      std::string::npos);
}

TEST(Plots, WriteAUnitAtEveryAxis) {
  const std::string svg = svg_of(Plot{"t", {"share"}, {"error", "m"}, {{"c", {1, 2}, {1, 2}}}, {}});
  EXPECT_EQ(count(svg, ">share [-]<"), 1u) << svg;  // a number
  EXPECT_EQ(count(svg, ">error [m]<"), 1u) << svg;
  EXPECT_EQ(count(svg_of(StackedBars{"t", {"share"}, {"a"}, {{"row", {1.0}}}}), ">share [-]<"), 1u);
}

/// The widths of a drawing's bars.
std::vector<double> widths_of(const std::string& svg) {
  std::vector<double> widths;
  for (std::size_t at = svg.find("<rect x="); at != std::string::npos;
       at = svg.find("<rect x=", at + 1))
    if (svg.compare(svg.find("height=\"", at) + 8, 2, "17") == 0)
      widths.push_back(std::stod(svg.substr(svg.find("width=\"", at) + 7)));
  return widths;
}

TEST(StackedBars, HaveTheLengthsOfTheirPartsAndNumberTheWideOnes) {
  const std::string svg = svg_of(StackedBars{
      "t", {"share", "%"}, {"a", "b", "c"}, {{"first", {60, 39, 1}}, {"second", {0, 50, 0}}}});
  const std::vector<double> widths = widths_of(svg);
  ASSERT_EQ(widths.size(), 4u) << svg;  // a part of 0 is not drawn
  // The longest row, 100, has 408 units; widths are written to a tenth of a unit.
  for (const auto& [k, value] : {std::pair{0, 60.0}, {1, 39.0}, {2, 1.0}, {3, 50.0}})
    EXPECT_NEAR(widths[static_cast<std::size_t>(k)], 4.08 * value, 0.05 + 1e-9) << k;
  for (const char* number : {">60<", ">39<", ">50<"}) EXPECT_GE(count(svg, number), 1u) << number;
  EXPECT_EQ(count(svg, ">1<"), 0u);
  EXPECT_EQ(count(svg, ">0<"), 1u);  // the first tick: 0, not -0
  EXPECT_THROW(svg_of(StackedBars{"t", {"share"}, {"a", "b"}, {{"row", {1.0}}}}),
               PreconditionError);
}

// Rounded to whole numbers, a time of 0.7 ms would be the same as one of 1.2 ms.
TEST(StackedBars, NumberSmallPartsWithDecimalsAndCountsInWholeNumbers) {
  const std::string times =
      svg_of(StackedBars{"t", {"CPU time", "ms"}, {"a"}, {{"ca", {0.709}}, {"rd", {1.15}}}});
  EXPECT_EQ(count(times, ">0.71<"), 1u) << times;
  EXPECT_EQ(count(times, ">1.1<") + count(times, ">1.2<"), 1u) << times;
  EXPECT_EQ(count(times, ">0.2<"), 1u) << times;  // a tick
  const std::string submissions =
      svg_of(StackedBars{"t", {"submissions"}, {"a"}, {{"0 to 10 %", {1}}, {"to 100 %", {2}}}});
  EXPECT_EQ(submissions.find(">0.5<"), std::string::npos) << submissions;
  EXPECT_EQ(count(submissions, ">2<"), 2u) << submissions;  // at the axis and in the bar
}

// Shrunk to the room at the left a long name could not be read.
TEST(StackedBars, ALongNameHasTwoLinesOfTheSameLettersAsAShortOne) {
  const std::string svg =
      svg_of(StackedBars{"t",
                         {"share", "%"},
                         {"a"},
                         {{"Euler, 1/60 s", {60}},
                          {"Dormand-Prince 5(4), joint coordinates, tolerance 1e-12", {40}}}});
  EXPECT_EQ(count(svg, ">Euler, 1/60 s<"), 1u) << svg;
  EXPECT_EQ(count(svg, ">Dormand-Prince 5(4), joint<"), 1u) << svg;
  EXPECT_EQ(count(svg, ">coordinates, tolerance 1e-12<"), 1u) << svg;
  EXPECT_EQ(count(svg, "font-size"), 1u) << svg;  // of the title
}

TEST(StackedBars, EightPartsHaveEightFills) {
  StackedBars bars{"t", {"share"}, {}, {{"row", {}}}};
  for (int k = 0; k < 8; ++k)
    bars.parts.push_back("part " + std::to_string(k)), bars.rows[0].values.push_back(1.0);
  const std::string svg = svg_of(bars);
  std::set<std::string> fills;
  for (std::size_t at = svg.find("height=\"17\" fill=\""); at != std::string::npos;
       at = svg.find("height=\"17\" fill=\"", at + 1))
    fills.insert(svg.substr(at + 18, svg.find('"', at + 18) - at - 18));
  EXPECT_EQ(fills.size(), 8u);
}

// A mark of a curve covers no word.
TEST(Plots, NamesOfLimitsLieAboveTheCurves) {
  const Plot plot{"t", {"x"}, {"y"}, {{"c", {1, 2}, {1, 2}, true}}, {{1.5, "band"}}};
  for (const std::string& svg : {svg_of(plot), narrow_svg_of(plot)})
    EXPECT_GT(svg.find(">band<"), svg.find("<path d=\"M")) << svg;
}

TEST(Plots, EscapeAllText) {
  const std::string svg =
      svg_of(Plot{"<script>", {"<a>", "<b>"}, {"y"}, {{"<c>", {1, 2}, {1, 2}}}, {{1.5, "<d>"}}});
  for (const char* bad : {"<script>", "<a>", "<b>", "<c>", "<d>"})
    EXPECT_EQ(svg.find(bad), std::string::npos) << bad;
}

TEST(Plots, KeepTheExtremaOfLongCurves) {
  Curve curve{"long", {}, {}};
  for (int i = 0; i < 100000; ++i)
    curve.x.push_back(i), curve.y.push_back(i == 54321 ? 100.0 : 0.0);
  const std::string svg = svg_of(Plot{"t", {"x"}, {"y"}, {curve}, {}});
  EXPECT_LT(svg.size(), 60000u);
  // the peak, 6 of 112 parts of 272 units below the top at 34
  EXPECT_NE(svg.find(" 48.6"), std::string::npos);
}

TEST(Plots, KeepWhatFollowsAMissingValueOfALongCurve) {
  Curve curve{"long", {}, {}};
  for (int i = 0; i < 100000; ++i)
    curve.x.push_back(i), curve.y.push_back(i == 54321 ? 100.0 : 0.0);
  curve.y[54300] = std::nan("");  // the first of the hundred that are drawn together
  EXPECT_NE(svg_of(Plot{"t", {"x"}, {"y"}, {curve}, {}}).find(" 48.6"), std::string::npos);
}

TEST(Plots, NumbersAtTheAxisOfALargeConstantDiffer) {
  const std::string svg = svg_of(Plot{
      "t", {"time", "s"}, {"momentum", "kg m/s"}, {{"c", {1, 2, 3}, {1e6, 1e6 + 0.01, 1e6}}}, {}});
  EXPECT_EQ(count(svg, ">1e6<"), 1u) << svg;
}

TEST(Plots, AreInAPageWithTheirCaption) {
  Page page("t");
  page.plot(Plot{"title", {"x"}, {"y"}, {{"c", {1, 2}, {1, 2}}}, {}, "what to see"});
  EXPECT_EQ(count(page.html(), "<svg"), 2u);  // wide and narrow
  EXPECT_NE(page.html().find("<figcaption>what to see</figcaption>"), std::string::npos);
}

TEST(Plot, SixteenCurvesDifferInTheLegend) {
  Plot plot{"Sixteen", {"x"}, {"y"}, {}, {}, ""};
  for (int i = 0; i < 16; ++i)
    plot.curves.push_back({"curve " + std::to_string(i), {0.0, 1.0}, {0.0, 1.0 + i}, true});
  const std::string svg = svg_of(plot);
  std::set<std::string> lines, marks;  // stroke and dashes; shape, fill and colour
  const std::string from = "<text x=";
  for (int i = 0; i < 16; ++i) {
    const auto name = svg.find(">curve " + std::to_string(i) + "<"),
               line = svg.rfind("<line", name);
    const std::string row = svg.substr(line, name - line);
    lines.insert(row.substr(row.find("stroke="), row.find("/>") - row.find("stroke=")));
    const auto outline = row.find(" d=");
    marks.insert(
        row.substr(outline == std::string::npos ? row.find(" r=") : outline,
                   row.find("<text") - (outline == std::string::npos ? row.find(" r=") : outline)));
  }
  EXPECT_EQ(lines.size(), 16u);
  EXPECT_EQ(marks.size(), 16u);
}

TEST(Plot, LongCurvesHaveAFewMarksWhereColoursRepeat) {
  Plot few{"Few", {"x"}, {"y"}, {}, {}, ""}, many = few;
  Curve curve{"c", {}, {}};
  for (int i = 0; i < 100; ++i) curve.x.push_back(i), curve.y.push_back(i);
  for (int i = 0; i < 3; ++i) few.curves.push_back(curve);
  for (int i = 0; i < 12; ++i) many.curves.push_back(curve);
  EXPECT_EQ(svg_of(few).find("<circle"), std::string::npos);
  EXPECT_NE(svg_of(many).find("<circle"), std::string::npos);
}

TEST(Plot, NamesCurvesThatCoverEachOther) {
  Plot plot{.title = "t", .x = {"n"}, .y = {"time", "s", Scale::kLog}, .curves = {}, .limits = {}};
  plot.curves = {{"A", {1, 2, 3}, {1, 10, 100}},
                 {"B", {1, 2, 3}, {1.001, 10, 100}},  // a thousandth of two decades: 0.1 units
                 {"C", {1, 2, 3}, {1, 11, 100}},      // 4 % of a decade: 6 units
                 {"D", {1, 2, 4}, {1, 10, 100}}};     // at another place
  EXPECT_EQ(coinciding(plot), std::vector<std::string>{"A and B"});
  EXPECT_NE(svg_of(plot).find("One covers the other: A and B</text>"), std::string::npos);
  plot.curves[1].name = "B, order 4";  // a comma in a name leaves open where the next one begins
  EXPECT_EQ(coinciding(plot), std::vector<std::string>{"A; B, order 4"});
}

TEST(Plot, SortsPointsOfAMeasuredPrice) {
  const Curve curve = sorted_by_x({"A", {3, 1, 2}, {30, 10, 20}, true});
  EXPECT_EQ(curve.x, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(curve.y, (std::vector<double>{10, 20, 30}));
}

}  // namespace
}  // namespace tumble::testing
