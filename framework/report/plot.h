/// Plots as SVG that stands in a page: curves over linear or logarithmic axes, with units, and lines that a curve shall not cross.
///
///   Plot plot{.title = "Energy of a stiff spring", .x = {"step"}, .y = {"E / E0", "-", Scale::kLog}};
///   plot.curves.push_back({"explicit Euler", steps, energies});
///   plot.limits.push_back({39.0, "band of symplectic Euler"});
///   page.plot(plot);
///
/// Curves differ in lightness, in dashes and in marks, and each has its name at a place of its own, so that print and colour-blind
/// readers can tell them apart. No script, no file beside the page.
#pragma once

#include <string>
#include <vector>

namespace tumble::report {

/// From this curve on, styles are those of the first eight again, dashed, thinner and with hollow marks: of a reference beside what is compared with it.
inline constexpr std::size_t kReferenceStyles = 8;

enum class Scale { kLinear, kLog };

struct Axis {
  std::string name;             // "time", "error of the top rod's tension"
  std::string unit = {};        // "s"; empty: a number, written [-]
  Scale scale = Scale::kLinear;
};

/// Points in order, joined by lines. Points that are not finite, or not positive on a logarithmic axis, break the line.
struct Curve {
  std::string name;             // "" : not in the legend
  std::vector<double> x, y;     // as many
  bool marks = false;           // a mark at each point: for few points; else a few along it where there are more than 8 curves
};

/// A horizontal line: what the curves are judged by.
struct Limit {
  double y;
  std::string name;
};

struct Plot {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves;    // told apart up to 16
  std::vector<Limit> limits;
  std::string caption = {};     // what to see in it
};

/// The ticks of an axis: round numbers that span [low, high], some 4 to 8 of them; powers of ten (or some of them) where logarithmic.
/// @pre low < high, finite; positive where logarithmic
std::vector<double> ticks_of(double low, double high, Scale scale);

/// CSS rules that svg_of relies on: a page holds them once.
const char* plot_style();

/// <svg> element of 640 x 360 units. A plot without a point to draw says so in the frame.
/// Curves of more than 2000 points are drawn by the least and the largest of each of 1000 parts.
std::string svg_of(const Plot& plot);

}  // namespace tumble::report
