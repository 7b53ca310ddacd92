#include "framework/report/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/report/html_text.h"

namespace tumble::report {
namespace {

// Units of the drawing. Numbers are at the left of the frame, names below it.
constexpr double kWidth = 640, kHeight = 360, kLeft = 78, kRight = 622, kTop = 34, kBottom = 306;
constexpr std::size_t kMostPoints = 2000, kParts = 1000;
constexpr std::size_t kLeastTicks = 3;  // numbers on an axis: fewer do not tell its scale
constexpr double kTextHeight = 17;
constexpr double kLetter = 0.64;  // mean width of a bold letter over its size
// on a logarithmic axis: smaller values are rounding, drawn at the edge
constexpr double kMostDecades = 40.0;
// largest over smallest: below it values are drawn as equal
constexpr double kFlat = 1.001;
// on a linear axis: length of the shortest over its largest value; numbers have six digits
constexpr double kFlatShare = 1e-4;

// From dark to light for print, distinguishable to colour-blind readers (after M. Okabe, K. Ito,
// "Color universal design", 2008). More than eight colours are hard to distinguish: the second
// eight curves repeat them with other dashes, thinner lines and hollow marks.
struct Style {
  const char *colour, *dashes;
};
constexpr Style kStyles[] = {{"#00446b", ""},         {"#c14d00", "7 3"},
                             {"#007a57", "2 2.5"},    {"#9a4f86", "9 3 2 3"},
                             {"#3d8fc4", "4 2"},      {"#8a6d00", "1.5 4"},
                             {"#222222", "12 4"},     {"#b5465f", "5 2 1.5 2 1.5 2"},
                             {"#00446b", "3 5"},      {"#c14d00", ""},
                             {"#007a57", "10 2 2 2"}, {"#9a4f86", "1 2"},
                             {"#3d8fc4", "14 5"},     {"#8a6d00", "6 2 1 2 1 2 1 2"},
                             {"#222222", "2 6"},      {"#b5465f", ""}};
constexpr std::size_t kColours = 8;      // and shapes of marks
constexpr std::size_t kMarksOfLong = 6;  // per curve without marks, where colours repeat

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
                 room = std::pow(10.0, 0.06 * decades);
    return {range.low / room, range.high * room};
  }
  // A curve that is constant to four digits is drawn as a straight line, with numbers that differ.
  const double size = range.high - range.low,
               least = kFlatShare * std::max(std::abs(range.low), std::abs(range.high));
  const double room = size > 0 || least > 0 ? std::max(0.06 * size, 0.5 * (least - size)) : 1.0;
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

std::string grid(const Axis& axis, const Scaled& at, bool across) {
  std::string svg;
  const std::vector<double> ticks = ticks_of(at.low, at.high, axis.scale);
  const double spacing = ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  for (double tick : ticks) {
    if (axis.scale == Scale::kLinear && std::abs(tick) < 1e-9 * spacing) tick = 0.0;
    const double p = at(tick);
    const double exponent = axis.scale == Scale::kLog ? std::round(std::log10(tick)) : 0.0;
    const bool is_power =
        axis.scale == Scale::kLog && std::abs(tick - std::pow(10.0, exponent)) < 1e-6 * tick;
    const std::string number = is_power && (tick < 1e-3 || tick > 9999)
                                   ? fmt::format("1e{:.0f}", exponent)
                                   : fmt::format("{:.6g}", tick);
    svg +=
        across
            ? line(kLeft, p, kRight, p, "class=\"grid\"") + text(kLeft - 7, p + 4, number, "end")
            : line(p, kTop, p, kBottom, "class=\"grid\"") + text(p, kBottom + 17, number, "middle");
  }
  return svg;
}

// The minimum and maximum of each part in their order: all that a thousand columns of a screen can
// show.
Curve thinned(const Curve& curve) {
  if (curve.x.size() <= kMostPoints) return curve;
  Curve thin{curve.name, {}, {}, curve.marks};
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t begin = part * curve.x.size() / kParts,
                      end = (part + 1) * curve.x.size() / kParts;
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

const Style& style_of(std::size_t place) { return kStyles[place % std::size(kStyles)]; }
bool is_hollow(std::size_t place) { return place % std::size(kStyles) >= kColours; }
double width_of(std::size_t place) { return is_hollow(place) ? 1.2 : 1.8; }

// Outlines in units of a mark's radius around its centre: a circle (empty), square, triangle,
// diamond, inverted triangle, cross, star, hexagon.
constexpr const char* kOutlines[kColours] = {
    "",
    "M-1 -1H1V1H-1z",
    "M0 -1.3L1.2 0.9H-1.2z",
    "M0 -1.4L1.1 0L0 1.4L-1.1 0z",
    "M-1.2 -0.9H1.2L0 1.3z",
    "M-1.3 -0.45H-0.45V-1.3H0.45V-0.45H1.3V0.45H0.45V1.3H-0.45V0.45H-1.3z",
    "M0 -1.5L0.4 -0.4L1.5 0L0.4 0.4L0 1.5L-0.4 0.4L-1.5 0L-0.4 -0.4z",
    "M-0.6 -1.1H0.6L1.2 0L0.6 1.1H-0.6L-1.2 0z"};

std::string mark(double x, double y, std::size_t place) {
  constexpr double r = 3.2;
  const char* outline = kOutlines[place % kColours];
  const std::string paint =
      is_hollow(place)
          ? fmt::format("fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.3\"", style_of(place).colour)
          : fmt::format("fill=\"{}\"", style_of(place).colour);
  if (*outline == '\0')
    return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" {}/>", x, y, r, paint);
  return fmt::format(
      "<path transform=\"translate({:.1f} {:.1f}) scale({})\" vector-effect=\"non-scaling-stroke\" "
      "d=\"{}\" {}/>",
      x, y, r, outline, paint);
}

std::string dashes_of(std::size_t place) {
  const char* dashes = style_of(place).dashes;
  return *dashes == '\0' ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes);
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
      path, style_of(place).colour, width_of(place), dashes_of(place), marks);
}

// Below the name of the axis, in rows.
std::string legend(const Plot& plot, double& bottom) {
  std::string svg;
  double x = kLeft, y = kBottom + 58;
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    if (plot.curves[i].name.empty()) continue;
    const double width = 44 + 6.6 * static_cast<double>(plot.curves[i].name.size());
    if (x > kLeft && x + width > kRight) {
      x = kLeft;
      y += kTextHeight;
    }
    svg += line(x, y - 4, x + 28, y - 4,
                fmt::format("stroke=\"{}\" stroke-width=\"{}\"{}", style_of(i).colour,
                            width_of(i) + 0.6, dashes_of(i)));
    if (points_a_mark(plot.curves[i], plot) > 0) svg += mark(x + 14, y - 4, i);
    svg += text(x + 34, y, plot.curves[i].name, "start");
    x += width;
  }
  bottom = y + 10;
  return svg;
}

// The frame of the plot's points, as drawn.
struct PlotFrame {
  Scaled x, y;
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
  for (const Limit& limit : plot.limits)
    if (drawable(limit.y, plot.y.scale)) ys.hold(limit.y);
  const Range across = widened(xs, plot.x.scale), up = widened(ys, plot.y.scale);
  return {{plot.x.scale, across.low, across.high, kLeft, kRight},
          {plot.y.scale, up.low, up.high, kBottom, kTop},
          is_empty};
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
  const Scaled y = frame_of(plot).y;
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
    if (names.size() > 1) groups.push_back(fmt::format("{}", fmt::join(names, " and ")));
  }
  return groups;
}

std::vector<double> ticks_of(double low, double high, Scale scale) {
  require(low < high && std::isfinite(low) && std::isfinite(high) &&
              (scale == Scale::kLinear || low > 0),
          "report: a plot's axis needs low < high");
  std::vector<double> ticks;
  if (scale == Scale::kLog && high / low >= 20) {
    const int first = static_cast<int>(std::ceil(std::log10(low) - 1e-9)),
              last = static_cast<int>(std::floor(std::log10(high) + 1e-9));
    const int stride = std::max(1, (last - first + 6) / 7);
    for (int power = first; power <= last; power += stride) ticks.push_back(std::pow(10.0, power));
    if (ticks.size() >= kLeastTicks) return ticks;
    ticks.clear();  // between the powers, too
    for (int power = first - 1; power <= last; ++power)
      for (const double part : {1.0, 2.0, 5.0}) {
        const double tick = part * std::pow(10.0, power);
        if (tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9)) ticks.push_back(tick);
      }
    return ticks;
  }
  const double rough = (high - low) / 6, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double part = rough / power, spacing = (part > 5   ? 10
                                                : part > 2 ? 5
                                                : part > 1 ? 2
                                                           : 1) *
                                               power;
  for (double tick = std::ceil(low / spacing - 1e-9) * spacing; tick <= high + 1e-9 * spacing;
       tick += spacing)
    ticks.push_back(tick);
  return ticks;
}

const char* plot_style() {
  return R"(
svg.plot { font: 11.5px "DejaVu Sans", Arial, sans-serif; fill: #1c2733; }
svg.plot .grid { stroke: #d9e0e6; stroke-width: .8; }
svg.plot .halo { paint-order: stroke; stroke: #fff; stroke-width: 3px; }
)";
}

std::string svg_of(const Plot& plot) {
  const auto [x, y, is_empty] = frame_of(plot);
  const double room =
      (kRight - kLeft) / (kLetter * std::max<double>(1.0, static_cast<double>(plot.title.size())));
  std::string body =
      text(kLeft, 20, plot.title, "start",
           fmt::format(" font-weight=\"bold\" font-size=\"{:.3g}\"", std::min(13.5, room)));
  body += grid(plot.y, y, true) + grid(plot.x, x, false);
  body += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#5b6875\"/>\n",
      kLeft, kTop, kRight - kLeft, kBottom - kTop);
  for (const Limit& limit : plot.limits) {
    if (!drawable(limit.y, plot.y.scale)) continue;
    const double at = y(limit.y);
    body += line(kLeft, at, kRight, at,
                 "stroke=\"#a82c00\" stroke-width=\"1.4\" stroke-dasharray=\"12 4\"");
    body += text(kRight - 5, at > kTop + 20 ? at - 5 : at + 14, limit.name, "end",
                 " fill=\"#a82c00\" class=\"halo\"");
  }
  for (std::size_t i = 0; i < plot.curves.size(); ++i)
    body += draw(thinned(plot.curves[i]), i, plot, x, y);
  if (is_empty)
    body += text(0.5 * (kLeft + kRight), 0.5 * (kTop + kBottom), "nothing to draw", "middle");
  body += text(0.5 * (kLeft + kRight), kBottom + 36, words_of(plot.x), "middle");
  body += text(0, 0, words_of(plot.y), "middle",
               fmt::format(" transform=\"translate(15 {}) rotate(-90)\"", 0.5 * (kTop + kBottom)));
  double bottom = kHeight;
  body += legend(plot, bottom);
  for (const std::string& names : coinciding(plot)) {
    bottom += kTextHeight;
    const std::string words = "One covers the other: " + names;
    const double fits = (kRight - kLeft) / (kLetter * static_cast<double>(words.size()));
    body += text(kLeft, bottom - 10, words, "start",
                 fmt::format(" font-size=\"{:.3g}\"", std::min(11.5, fits)));
  }
  return fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"{}\">\n{}</svg>\n",
      kWidth, std::max(bottom, kBottom + 46.0), html_escape(plot.title), body);
}

}  // namespace tumble::report
