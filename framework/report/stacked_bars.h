/// Horizontal stacked bars as inline SVG, in the style of plot.h.
///
///   page.plot(StackedBars{.title = "Where the time went", .axis = {"share of the time", "%"},
///   .parts = {"detect", "integrate"}, .rows = {{"RK4, 1/60 s", {30.0, 70.0}}}});
///
/// Parts differ in lightness and hatching, and wide ones show their number, so that they are
/// distinguishable in print and to colour-blind readers.
#pragma once

#include <string>
#include <vector>

#include "framework/report/plot.h"

namespace tumble::report {

struct StackedBars {
  struct Row {
    std::string name;
    std::vector<double> values;  // >= 0, one for each part; all 0: an empty bar
  };
  std::string title;
  Axis axis;                       // linear, from 0 to the longest row's sum
  std::vector<std::string> parts;  // distinguishable up to 8
  std::vector<Row> rows;           // from the top
  std::string caption = {};        // what the bars show
  bool is_small = false;           // short names and few numbers: narrow enough for a phone
};

/// An <svg> element, 640 units wide, 360 where small.
/// @param number  of the chart on its page, so that each has ids of its own
/// @pre every row has one finite value >= 0 for each part
std::string svg_of(const StackedBars& bars, int number = 1);

/// The same for a column of a phone, 340 units wide, with names above their bars.
std::string narrow_svg_of(const StackedBars& bars, int number = 1);

}  // namespace tumble::report
