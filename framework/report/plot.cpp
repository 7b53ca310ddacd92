#include "framework/report/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/report/curve_styles.h"
#include "framework/report/html_text.h"
#include "framework/report/ticks.h"

namespace tumble::report {
namespace {

constexpr double kTextHeight = 17, kTitleHeight = 16;
// widths of letters: the mean, one that lines are broken by, of a bold title, of a figure at an
// axis
constexpr double kMeanLetter = 6.6, kLetter = 7.2, kBoldLetter = 8.7, kFigure = 7.4;
constexpr std::size_t kMarksOfLong = 6;  // per curve without marks, where colours repeat
constexpr int kTicksOfWide = 6, kTicksOfNarrow = 4;  // along x
// on a logarithmic axis: smaller values are rounding, drawn at the edge
constexpr double kMostDecades = 40.0;
// largest over smallest: below it values are drawn as equal
constexpr double kFlat = 1.001;
// on a linear axis: length of the shortest over its largest value; numbers have six digits
constexpr double kFlatShare = 1e-4;
constexpr double kRoom = 0.06;  // between a curve and the frame, over the curve's length
// more of it below a limit under all curves, where its name hides none of them: together with kRoom
// 19 units of the lowest drawing's 210
constexpr double kRoomForName = 0.04;

// Where things stand, in units of the drawing. Numbers are at the left of the frame, names below
// it. In a narrow drawing the name of the upright axis stands above the frame.
struct Sheet {
  double width, left, right, top, bottom;
  std::size_t parts;  // of a long curve: columns of a screen
  bool is_narrow;

  std::size_t letters(double each) const {  // in a line
    return static_cast<std::size_t>((right - left) / each);
  }
};

struct Range {
  double low = std::numeric_limits<double>::infinity(),
         high = -std::numeric_limits<double>::infinity();
  void hold(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

bool drawable(double v, Scale scale) {
  return std::isfinite(v) && (scale == Scale::kLinear || v > 0);
}

// Adds margins, so that no curve runs along the frame.
Range widened(Range range, Scale scale) {
  if (!(range.low <= range.high)) return scale == Scale::kLog ? Range{0.1, 1.0} : Range{0.0, 1.0};
  if (scale == Scale::kLog) {
    range.low = std::max(range.low, range.high * std::pow(10.0, -kMostDecades));
    // equal values: show a decade on both sides, not the last digits
    if (range.high < kFlat * range.low) return {range.low / 10.0, range.high * 10.0};
    const double decades = std::max(std::log10(range.high / range.low), 0.5),
                 room = std::pow(10.0, kRoom * decades);
    return {range.low / room, range.high * room};
  }
  // A curve that is constant to four digits is drawn as a straight line, with numbers that differ.
  const double size = range.high - range.low,
               least = kFlatShare * std::max(std::abs(range.low), std::abs(range.high));
  const double room = std::max(kRoom * size, 0.5 * (least - size));
  if (room == 0) return {-kRoom, 1.0};  // 0 alone: counts, shares and errors are never below it
  return {range.low - room, range.high + room};
}

struct Scaled {
  Scale scale;
  double low, high, from, to;  // range of values, and its positions in the drawing
  double operator()(double v) const {
    const double part = scale == Scale::kLog
                            ? std::log(std::max(v, low) / low) / std::log(high / low)
                            : (v - low) / (high - low);
    return from + part * (to - from);
  }
};

std::string text(double x, double y, const std::string& words, const char* anchor,
                 const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                     anchor, more, html_escape(words));
}

std::string line(double x1, double y1, double x2, double y2, const std::string& stroke) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1,
                     x2, y2, stroke);
}

std::string words_of(const Axis& axis) {
  return fmt::format("{} [{}]", axis.name, axis.unit.empty() ? "-" : axis.unit);
}

std::string grid(const Axis& axis, const Scaled& at, const Sheet& sheet, bool across) {
  std::string svg;
  const int most = sheet.is_narrow && !across ? kTicksOfNarrow : kTicksOfWide;
  const std::vector<double> ticks = ticks_of(at.low, at.high, axis.scale, most);
  const std::vector<std::string> numbers = tick_words(ticks, axis.scale);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double p = at(ticks[i]);
    svg += across ? line(sheet.left, p, sheet.right, p, "class=\"grid\"") +
                        text(sheet.left - 7, p + 4, numbers[i], "end")
                  : line(p, sheet.top, p, sheet.bottom, "class=\"grid\"") +
                        text(p, sheet.bottom + 17, numbers[i], "middle");
  }
  return svg;
}

// The minimum and maximum of each part in their order: all that the columns of a screen can show.
Curve thinned(const Curve& curve, std::size_t parts) {
  if (curve.x.size() <= 2 * parts) return curve;
  Curve thin{curve.name, {}, {}, curve.marks};
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = part * curve.x.size() / parts,
                      end = (part + 1) * curve.x.size() / parts;
    std::size_t least = begin;
    while (least + 1 < end && !std::isfinite(curve.y[least])) ++least;  // nothing compares with it
    std::size_t largest = least;
    for (std::size_t i = least; i < end; ++i) {
      if (!std::isfinite(curve.y[i])) continue;
      if (curve.y[i] < curve.y[least]) least = i;
      if (curve.y[i] > curve.y[largest]) largest = i;
    }
    for (const std::size_t i : {std::min(least, largest), std::max(least, largest)}) {
      thin.x.push_back(curve.x[i]);
      thin.y.push_back(curve.y[i]);
    }
  }
  return thin;
}

// Interval between marked points of a curve; 0: no marks.
std::size_t points_a_mark(const Curve& curve, const Plot& plot) {
  if (curve.marks) return 1;
  return plot.curves.size() > kColours ? std::max<std::size_t>(1, curve.x.size() / kMarksOfLong)
                                       : 0;
}

std::string draw(const Curve& curve, std::size_t place, const Plot& plot, const Scaled& x,
                 const Scaled& y) {
  // so that marks of similar curves do not overlap
  const std::size_t each = points_a_mark(curve, plot),
                    first = each > 1 ? place % kColours * each / kColours : 0;
  std::string path, marks;
  bool pen_down = false;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!drawable(curve.x[i], plot.x.scale) || !drawable(curve.y[i], plot.y.scale)) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? 'L' : 'M', x(curve.x[i]), y(curve.y[i]));
    pen_down = true;
    if (each > 0 && i % each == first) marks += mark(x(curve.x[i]), y(curve.y[i]), place);
  }
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
      "stroke-linejoin=\"round\"{}/>\n{}",
      path, colour_of(place), width_of(place), dashes_of(place), marks);
}

constexpr const char* kLimitStroke =
    "stroke=\"#a82c00\" stroke-width=\"1.4\" stroke-dasharray=\"12 4\"";

// Below the name of the axis, in rows; a name too long for one goes on in the next.
// @param limits  names of limits that have no room at their lines
std::string legend(const Plot& plot, const std::vector<std::string>& limits, const Sheet& sheet,
                   double& bottom) {
  constexpr double kKey = 34, kGap = 10;
  std::string svg;
  double x = sheet.left, y = bottom + 22;
  const double right = sheet.right;
  const auto most = static_cast<std::size_t>((right - sheet.left - kKey) / kLetter);
  const auto add = [&](const std::string& name, const std::string& stroke, auto mark_at) {
    const std::vector<std::string> lines = wrapped(name, most);
    const double width = kKey + kGap + kMeanLetter * static_cast<double>(name.size());
    if (x > sheet.left && x + width > right) {
      x = sheet.left;
      y += kTextHeight;
    }
    svg += line(x, y - 4, x + 28, y - 4, stroke) + mark_at(x + 14, y - 4);
    svg += text(x + kKey, y, lines.front(), "start");
    for (std::size_t k = 1; k < lines.size(); ++k)
      svg += text(x + kKey, y += kTextHeight, lines[k], "start");
    x += width;
  };
  for (std::size_t i = 0; i < plot.curves.size(); ++i)
    if (!plot.curves[i].name.empty())
      add(plot.curves[i].name,
          fmt::format("stroke=\"{}\" stroke-width=\"{}\"{}", colour_of(i), width_of(i) + 0.6,
                      dashes_of(i)),
          [&](double at_x, double at_y) {
            return points_a_mark(plot.curves[i], plot) > 0 ? mark(at_x, at_y, i) : "";
          });
  for (const std::string& name : limits) add(name, kLimitStroke, [](double, double) { return ""; });
  if (!svg.empty()) bottom = y + 10;
  return svg;
}

// The ranges of the plot's points.
struct PlotFrame {
  Range x, y;
  bool is_empty;
};

PlotFrame frame_of(const Plot& plot) {
  Range xs, ys;
  for (const Curve& curve : plot.curves) {
    require(curve.x.size() == curve.y.size(), "report: a curve needs x and y of equal length");
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!drawable(curve.x[i], plot.x.scale) || !drawable(curve.y[i], plot.y.scale)) continue;
      xs.hold(curve.x[i]);
      ys.hold(curve.y[i]);
    }
  }
  const bool is_empty = !(xs.low <= xs.high);
  bool is_limit_lowest = false;
  for (const Limit& limit : plot.limits)
    if (drawable(limit.y, plot.y.scale)) {
      is_limit_lowest |= limit.y <= ys.low;
      ys.hold(limit.y);
    }
  Range up = widened(ys, plot.y.scale);
  if (is_limit_lowest && !is_empty)
    up.low -= plot.y.scale == Scale::kLog
                  ? up.low * (1.0 - std::pow(up.low / up.high, kRoomForName))
                  : kRoomForName * (up.high - up.low);
  return {widened(xs, plot.x.scale), up, is_empty};
}

constexpr Sheet kWide = {640, 78, 622, 34, 306, 1000, false};
constexpr double kNarrowWidth = 340, kNarrowHeight = 210;

// The frame begins below the title, of however many lines.
Sheet wide_sheet(const Plot& plot) {
  Sheet sheet = kWide;
  const auto lines = wrapped(plot.title, sheet.letters(kBoldLetter)).size();
  const double more = kTitleHeight * static_cast<double>(lines - 1);
  sheet.top += more;
  sheet.bottom += more;
  return sheet;
}

// As wide as numbers at the left need it, below its title and the name of the upright axis.
Sheet narrow_sheet(const Plot& plot, const Range& up) {
  std::size_t longest = 1;
  for (const std::string& number :
       tick_words(ticks_of(up.low, up.high, plot.y.scale, kTicksOfWide), plot.y.scale))
    longest = std::max(longest, number.size());
  constexpr double kMargin = 8;
  Sheet sheet{kNarrowWidth, kMargin, kNarrowWidth - 18, 0, 0, 250, true};
  sheet.top =
      10 +
      kTitleHeight * static_cast<double>(wrapped(plot.title, sheet.letters(kBoldLetter)).size()) +
      kTextHeight * static_cast<double>(wrapped(words_of(plot.y), sheet.letters(kLetter)).size());
  sheet.bottom = sheet.top + kNarrowHeight;
  sheet.left = kMargin + kFigure * static_cast<double>(longest);
  return sheet;
}

// Title and, where it stands above the frame, the name of the upright axis.
std::string heading_of(const Plot& plot, const Sheet& sheet) {
  Sheet page = sheet;
  if (sheet.is_narrow) page.left = 8;
  std::string svg;
  double y = sheet.is_narrow ? 16 : 20;
  for (const std::string& words : wrapped(plot.title, page.letters(kBoldLetter))) {
    svg += text(page.left, y, words, "start", " font-weight=\"bold\" font-size=\"13.5\"");
    y += kTitleHeight;
  }
  if (!sheet.is_narrow)
    return svg + text(0, 0, words_of(plot.y), "middle",
                      fmt::format(" transform=\"translate(15 {}) rotate(-90)\"",
                                  0.5 * (sheet.top + sheet.bottom)));
  for (const std::string& words : wrapped(words_of(plot.y), page.letters(kLetter))) {
    svg += text(page.left, y, words, "start");
    y += kTextHeight;
  }
  return svg;
}

// Below everything: what covers what.
std::string covering(const Plot& plot, const Sheet& sheet, double& bottom) {
  std::string svg;
  for (const std::string& names : coinciding(plot))
    for (const std::string& words :
         wrapped("One covers the other: " + names, sheet.letters(kLetter))) {
      bottom += kTextHeight;
      svg += text(sheet.left, bottom - 10, words, "start");
    }
  return svg;
}

struct Box {
  double left, right, top, bottom;
  bool holds(double x, double y) const { return x > left && x < right && y > top && y < bottom; }
};

// How much of the curves lies in the box: parts of lines, each an eighth of what is between points.
std::size_t drawn_in(const Box& box, const Plot& plot, const Scaled& x, const Scaled& y) {
  constexpr int kParts = 8;
  std::size_t parts = 0;
  for (const Curve& curve : plot.curves)
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const std::size_t next = std::min(i + 1, curve.x.size() - 1);
      const double x0 = x(curve.x[i]), y0 = y(curve.y[i]), x1 = x(curve.x[next]),
                   y1 = y(curve.y[next]);
      for (int part = 0; part < kParts; ++part)
        parts += box.holds(x0 + part * (x1 - x0) / kParts, y0 + part * (y1 - y0) / kParts);
    }
  return parts;
}

// The name of a limit stands above its line at the right, or where it hides none of the curves;
// empty: it would hide some of them everywhere.
std::string name_of(const Limit& limit, const Plot& plot, const Sheet& sheet, const Scaled& x,
                    const Scaled& y) {
  constexpr double kInside = 5, kAbove = 5, kBelow = 15, kHeight = 14;
  const double at = y(limit.y),
               width = kMeanLetter * static_cast<double>(limit.name.size()) + kInside;
  for (const double base : {at - kAbove, at + kBelow})
    for (const bool is_right : {true, false}) {
      const double edge = is_right ? sheet.right - kInside : sheet.left + kInside;
      const Box box{is_right ? edge - width : edge, is_right ? edge : edge + width, base - kHeight,
                    base + kInside};
      if (box.top < sheet.top || base > sheet.bottom - 1 || box.left < sheet.left) continue;
      if (drawn_in(box, plot, x, y) == 0)
        return text(edge, base, limit.name, is_right ? "end" : "start",
                    " fill=\"#a82c00\" class=\"halo\"");
    }
  return "";
}

std::string drawn_on(const Plot& plot, const PlotFrame& frame, const Sheet& sheet) {
  const double middle = 0.5 * (sheet.left + sheet.right);
  const Scaled x{plot.x.scale, frame.x.low, frame.x.high, sheet.left, sheet.right};
  const Scaled y{plot.y.scale, frame.y.low, frame.y.high, sheet.bottom, sheet.top};
  std::string body = heading_of(plot, sheet);
  body += grid(plot.y, y, sheet, true) + grid(plot.x, x, sheet, false);
  body += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\" fill=\"none\" "
      "stroke=\"#5b6875\"/>\n",
      sheet.left, sheet.top, sheet.right - sheet.left, sheet.bottom - sheet.top);
  std::string names;  // above the curves
  std::vector<std::string> without_room;
  for (const Limit& limit : plot.limits) {
    if (!drawable(limit.y, plot.y.scale)) continue;
    const double at = y(limit.y);
    body += line(sheet.left, at, sheet.right, at, kLimitStroke);
    const std::string name = name_of(limit, plot, sheet, x, y);
    if (name.empty()) without_room.push_back(limit.name);
    names += name;
  }
  for (std::size_t i = 0; i < plot.curves.size(); ++i)
    body += draw(thinned(plot.curves[i], sheet.parts), i, plot, x, y);
  body += names;
  if (frame.is_empty)
    body += text(middle, 0.5 * (sheet.top + sheet.bottom), "nothing to draw", "middle");
  double bottom = sheet.bottom + 19;
  for (const std::string& words : wrapped(words_of(plot.x), sheet.letters(kLetter)))
    body += text(middle, bottom += kTextHeight, words, "middle");
  body += legend(plot, without_room, sheet, bottom);
  body += covering(plot, sheet, bottom);
  return fmt::format(
      "<svg class=\"plot{}\" viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"{}\">\n"
      "{}</svg>\n",
      sheet.is_narrow ? " narrow" : "", sheet.width, bottom + 10, html_escape(plot.title), body);
}

// Whether nobody can see two curves apart.
bool covers(const Curve& a, const Curve& b, const Plot& plot, const Scaled& y) {
  constexpr double kWidthOfALine = 1.8;
  if (a.x != b.x || a.x.empty()) return false;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const bool is_drawn = drawable(a.y[i], plot.y.scale);
    if (is_drawn != drawable(b.y[i], plot.y.scale)) return false;
    if (is_drawn && std::abs(y(a.y[i]) - y(b.y[i])) > kWidthOfALine) return false;
  }
  return true;
}

}  // namespace

Curve sorted_by_x(Curve curve) {
  std::vector<std::size_t> order(curve.x.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return curve.x[i] < curve.x[j]; });
  Curve sorted = curve;
  for (std::size_t k = 0; k < order.size(); ++k) {
    sorted.x[k] = curve.x[order[k]];
    sorted.y[k] = curve.y[order[k]];
  }
  return sorted;
}

std::vector<std::string> coinciding(const Plot& plot) {
  const Range up = frame_of(plot).y;
  const Scaled y{plot.y.scale, up.low, up.high, kWide.bottom, kWide.top};
  std::vector<std::string> groups;
  std::vector<bool> is_named(plot.curves.size(), false);
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    if (is_named[i] || plot.curves[i].name.empty()) continue;
    std::vector<std::string> names = {plot.curves[i].name};
    for (std::size_t j = i + 1; j < plot.curves.size(); ++j)
      if (!is_named[j] && !plot.curves[j].name.empty() &&
          covers(plot.curves[i], plot.curves[j], plot, y)) {
        names.push_back(plot.curves[j].name);
        is_named[j] = true;
      }
    const bool has_comma = std::any_of(names.begin(), names.end(), [](const std::string& name) {
      return name.find(',') != std::string::npos;
    });
    if (names.size() > 1)
      groups.push_back(fmt::format("{}", fmt::join(names, has_comma ? "; " : " and ")));
  }
  return groups;
}

const char* plot_style() {
  return R"(
svg.plot { font: 11.5px "DejaVu Sans", Arial, sans-serif; fill: #1c2733; }
svg.plot .grid { stroke: #d9e0e6; stroke-width: .8; }
svg.plot .halo { paint-order: stroke; stroke: #fff; stroke-width: 3px; }
)";
}

std::string svg_of(const Plot& plot) { return drawn_on(plot, frame_of(plot), wide_sheet(plot)); }

std::string narrow_svg_of(const Plot& plot) {
  const PlotFrame frame = frame_of(plot);
  return drawn_on(plot, frame, narrow_sheet(plot, frame.y));
}

}  // namespace tumble::report
