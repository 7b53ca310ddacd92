/// What a whole is made of, as bars across: SVG that stands in a page, in the style of plot.h.
///
///   page.plot(StackedBars{.title = "Where the time went", .axis = {"share of the time", "%"}, .parts = {"detect", "integrate"}, .rows = {{"RK4, 1/60 s", {30.0, 70.0}}}});
///
/// Parts differ in lightness and in hatching, and wide ones bear their number, so that print and colour-blind readers can tell them apart.
#pragma once

#include <string>
#include <vector>

#include "framework/report/plot.h"

namespace tumble::report {

struct StackedBars {
  struct Row {
    std::string name;
    std::vector<double> values;   // >= 0, one for each part; all of them 0: an empty bar
  };
  std::string title;
  Axis axis;                      // linear, from 0 to the longest row's sum
  std::vector<std::string> parts; // told apart up to 8
  std::vector<Row> rows;          // from the top
  std::string caption = {};       // what to see in it
};

/// <svg> element of 640 units across; a row each.
/// @pre every row has as many values as there are parts, none of them negative or not finite
std::string svg_of(const StackedBars& bars);

}  // namespace tumble::report
