#include "framework/report/stacked_bars.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/report/html_text.h"
#include "framework/report/ticks.h"

namespace tumble::report {
namespace {

constexpr double kBar = 17, kTextHeight = 17, kNameHeight = 13;
constexpr double kLetter = 6.2;  // mean width of a letter
constexpr double kLegendLetter = 6.6, kTitleLetter = 8.7;

// Where things stand, in units of the drawing, with the width of plot.cpp: names at the left of
// their bars, or above them where the drawing is narrow.
struct BarSheet {
  double margin, width;  // of the drawing
  double left, right;    // of the bars
  double row;            // height
  bool is_narrow;
};
BarSheet sheet_of(const StackedBars& bars) {
  if (bars.is_small) return {18, 360, 96, 342, 24, false};
  return {18, 640, 214, 622, 24, false};
}
constexpr BarSheet kNarrowBars = {8, 340, 8, 318, 42, true};
constexpr double kRoomForNumber = 30;  // a narrower part shows no number

// Neighbours differ in lightness, and parts of equal lightness in hatching, so that they are
// distinguishable in grey.
struct Paint {
  const char *ground, *lines, *ink;  // colours: background; hatching, empty: none; number
  int turned;                        // angle of the hatching [deg]
};
constexpr Paint kPaints[] = {
    {"#00446b", "", "#fff", 0},          {"#f0c27b", "", "#1c2733", 0},
    {"#007a57", "#bfe3d6", "#fff", 45},  {"#d8e8f3", "#7fa6c4", "#1c2733", 135},
    {"#9a4f86", "", "#fff", 0},          {"#ffffff", "#8a6d00", "#1c2733", 0},
    {"#222222", "#9aa3ab", "#fff", 135}, {"#b9c3cc", "#5b6875", "#1c2733", 90}};

const Paint& paint_of(std::size_t part) { return kPaints[part % std::size(kPaints)]; }

std::string fill_of(std::size_t part, const std::string& number) {
  return *paint_of(part).lines == '\0'
             ? fmt::format("fill=\"{}\"", paint_of(part).ground)
             : fmt::format("fill=\"url(#bar{}-{})\"", number, part % std::size(kPaints));
}

std::string hatches(std::size_t parts, const std::string& number) {
  std::string defs;
  for (std::size_t part = 0; part < std::min(parts, std::size(kPaints)); ++part) {
    const Paint& paint = paint_of(part);
    if (*paint.lines == '\0') continue;
    defs += fmt::format(
        "<pattern id=\"bar{}-{}\" width=\"5\" height=\"5\" patternUnits=\"userSpaceOnUse\" "
        "patternTransform=\"rotate({})\"><rect width=\"5\" height=\"5\" fill=\"{}\"/>"
        "<path d=\"M0 0V5\" stroke=\"{}\" stroke-width=\"2\"/></pattern>\n",
        number, part, paint.turned, paint.ground, paint.lines);
  }
  return defs.empty() ? "" : "<defs>\n" + defs + "</defs>\n";
}

std::string text(double x, double y, const std::string& words, const char* anchor,
                 const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                     anchor, more, html_escape(words));
}

// At the left of a bar, in letters of one size.
std::vector<std::string> lines_of(const std::string& name, const BarSheet& sheet) {
  return wrapped(name, static_cast<std::size_t>((sheet.left - 12) / kLetter));
}

/// At the left of its bar, in two lines where it is long, or above it.
std::string name_of(const StackedBars::Row& row, double y, const BarSheet& sheet) {
  if (sheet.is_narrow) return text(sheet.left, y - 5, row.name, "start");
  const std::vector<std::string> lines = lines_of(row.name, sheet);
  std::string svg;
  double at = y + 0.5 * kBar + 4 - 0.5 * kNameHeight * static_cast<double>(lines.size() - 1);
  for (const std::string& line : lines) {
    svg += text(sheet.left - 7, at, line, "end");
    at += kNameHeight;
  }
  return svg;
}

bool is_whole(double value) { return value == std::round(value); }

// "1.2" of milliseconds: without its decimals it would be "1", as 0.7 is.
std::string number_of(double value) {
  return value < 10.0 && !is_whole(value) ? few_digits(value) : fmt::format("{:.0f}", value);
}

std::string bar(const StackedBars::Row& row, double y, double longest, const BarSheet& sheet,
                const std::string& number) {
  std::string svg = name_of(row, y, sheet);
  double x = sheet.left;
  for (std::size_t part = 0; part < row.values.size(); ++part) {
    const double wide =
        longest > 0.0 ? row.values[part] / longest * (sheet.right - sheet.left) : 0.0;
    if (wide <= 0.0) continue;
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\" {} stroke=\"#fff\" "
        "stroke-width=\".8\"/>\n",
        x, y, wide, kBar, fill_of(part, number));
    const std::string halo =
        *paint_of(part).lines == '\0'
            ? ""
            : fmt::format(" paint-order=\"stroke\" stroke=\"{}\" stroke-width=\"3\"",
                          paint_of(part).ground);
    if (wide >= kRoomForNumber)
      svg += text(x + 0.5 * wide, y + 0.5 * kBar + 4, number_of(row.values[part]), "middle",
                  fmt::format(" fill=\"{}\"{}", paint_of(part).ink, halo));
    x += wide;
  }
  return svg;
}

std::string legend(const StackedBars& bars, double& y, const BarSheet& sheet,
                   const std::string& number) {
  std::string svg;
  double x = sheet.margin;
  for (std::size_t part = 0; part < bars.parts.size(); ++part) {
    const double wide = 32 + kLegendLetter * static_cast<double>(bars.parts[part].size());
    if (x > sheet.margin && x + wide > sheet.right) {
      x = sheet.margin;
      y += kTextHeight;
    }
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"11\" {} stroke=\"#5b6875\" "
        "stroke-width=\".8\"/>\n",
        x, y - 10, fill_of(part, number));
    svg += text(x + 19, y, bars.parts[part], "start");
    x += wide;
  }
  return svg;
}

double longest_of(const StackedBars& bars) {
  double longest = 0.0;
  for (const StackedBars::Row& row : bars.rows) {
    require(row.values.size() == bars.parts.size(),
            "report: a row of bars needs a value for each part");
    for (const double value : row.values)
      require(std::isfinite(value) && value >= 0.0,
              "report: a part of a bar must be finite and not negative");
    longest = std::max(longest, std::accumulate(row.values.begin(), row.values.end(), 0.0));
  }
  return longest;
}

// Upright lines with their numbers, and the name of the axis.
std::string axis_of(const StackedBars& bars, const BarSheet& sheet, double longest, double top,
                    double bottom) {
  std::string svg;
  if (longest > 0.0) {
    std::vector<double> ticks = ticks_of(0.0, longest, Scale::kLinear, sheet.is_narrow ? 4 : 6);
    const bool counts = bars.axis.unit.empty() &&
                        std::all_of(bars.rows.begin(), bars.rows.end(), [](const auto& row) {
                          return std::all_of(row.values.begin(), row.values.end(), is_whole);
                        });
    if (counts)  // there is no half of a submission
      ticks.erase(std::remove_if(ticks.begin(), ticks.end(), std::not_fn(is_whole)), ticks.end());
    const std::vector<std::string> numbers = tick_words(ticks, Scale::kLinear);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      const double x = sheet.left + ticks[i] / longest * (sheet.right - sheet.left);
      svg += fmt::format(
                 "<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" class=\"grid\"/>\n",
                 x, top, bottom) +
             text(x, bottom + 15, numbers[i], "middle");
    }
  }
  return svg +
         text(0.5 * (sheet.left + sheet.right), bottom + 34,
              fmt::format("{} [{}]", bars.axis.name, bars.axis.unit.empty() ? "-" : bars.axis.unit),
              "middle");
}

// @param number  what makes the ids of this drawing differ from those of others
std::string bars_on(const StackedBars& bars, const BarSheet& sheet, const std::string& number) {
  const double longest = longest_of(bars);
  std::string body = hatches(bars.parts.size(), number);
  double top = 34;
  if (sheet.is_narrow) {
    top = 0;
    for (const std::string& words :
         wrapped(bars.title, static_cast<std::size_t>((sheet.right - sheet.margin) / kTitleLetter)))
      body +=
          text(sheet.margin, top += 16, words, "start", " font-weight=\"bold\" font-size=\"13.5\"");
    top += 6;
  } else {
    body += text(sheet.margin, 20, bars.title, "start", " font-weight=\"bold\" font-size=\"13.5\"");
  }
  const double bottom = top + sheet.row * static_cast<double>(bars.rows.size());
  body += axis_of(bars, sheet, longest, top, bottom);
  const double above = sheet.is_narrow ? sheet.row - kBar - 3 : 0.5 * (sheet.row - kBar);
  for (std::size_t i = 0; i < bars.rows.size(); ++i)
    body +=
        bar(bars.rows[i], top + sheet.row * static_cast<double>(i) + above, longest, sheet, number);
  double y = bottom + 58;
  body += legend(bars, y, sheet, number);
  return fmt::format(
      "<svg class=\"plot{}\" viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"{}\">\n"
      "{}</svg>\n",
      sheet.is_narrow ? " narrow" : "", sheet.width, y + 10, html_escape(bars.title), body);
}

}  // namespace

std::string svg_of(const StackedBars& bars, int number) {
  BarSheet sheet = sheet_of(bars);
  for (const StackedBars::Row& row : bars.rows)
    sheet.row = std::max(sheet.row,
                         4 + kNameHeight * static_cast<double>(lines_of(row.name, sheet).size()));
  return bars_on(bars, sheet, std::to_string(number));
}

std::string narrow_svg_of(const StackedBars& bars, int number) {
  return bars_on(bars, kNarrowBars, std::to_string(number) + "n");
}

}  // namespace tumble::report
