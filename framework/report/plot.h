/// Plots as inline SVG: curves over linear or logarithmic axes, with units and limits.
///
///   Plot plot{.title = "Energy of a stiff spring", .x = {"step"}, .y = {"E / E0", "-",
///   Scale::kLog}}; plot.curves.push_back({"explicit Euler", steps, energies});
///   plot.limits.push_back({39.0, "band of symplectic Euler"});
///   page.plot(plot);
///
/// Curves differ in lightness, dashes and marks, and have their names in a legend, so that they are
/// distinguishable in print and to colour-blind readers. No script and no other file.
#pragma once

#include <string>
#include <vector>

#include "framework/report/ticks.h"

namespace tumble::report {

/// From this curve on, the colours of the first eight are repeated with other dashes, thinner lines
/// and hollow marks: for a reference beside the curves compared with it.
inline constexpr std::size_t kReferenceStyles = 8;

struct Axis {
  std::string name;       // "time", "error of the top rod's tension"
  std::string unit = {};  // "s"; empty: a number, written [-]
  Scale scale = Scale::kLinear;
};

/// Points in order, joined by lines. Points that are not finite, or not positive on a logarithmic
/// axis, break the line.
struct Curve {
  std::string name;          // "" : not in the legend
  std::vector<double> x, y;  // of equal length
  // a mark at every point; otherwise a few marks, where there are more than 8 curves
  bool marks = false;
};

/// A horizontal line, such as a threshold.
struct Limit {
  double y;
  std::string name;
};

struct Plot {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves;  // distinguishable up to 16
  std::vector<Limit> limits;
  std::string caption = {};  // what the plot shows
};

/// The curve with its points from left to right: a measured price, such as CPU time, need not grow
/// with every finer step.
Curve sorted_by_x(Curve curve);

/// Names of curves that cover each other, the width of a line apart at most: "A and B". Compared
/// are curves with the same x.
std::vector<std::string> coinciding(const Plot& plot);

/// CSS rules that svg_of needs, once per page.
const char* plot_style();

/// An <svg> element, 640 units wide; names curves that cover each other; says where nothing can be
/// drawn. Of more than 2000 points are drawn the minimum and maximum of each of 1000 parts.
std::string svg_of(const Plot& plot);

/// The same for a column of a phone, 340 units wide: letters have the size that they have in the
/// wide one. A page that has both shows the one that fits (class "narrow").
std::string narrow_svg_of(const Plot& plot);

}  // namespace tumble::report
