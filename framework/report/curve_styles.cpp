#include "framework/report/curve_styles.h"

#include <iterator>

#include <fmt/format.h>

namespace tumble::report {
namespace {

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

bool is_hollow(std::size_t place) { return place % std::size(kStyles) >= kColours; }

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

}  // namespace

const char* colour_of(std::size_t place) { return kStyles[place % std::size(kStyles)].colour; }

double width_of(std::size_t place) { return is_hollow(place) ? 1.2 : 1.8; }

std::string dashes_of(std::size_t place) {
  const char* dashes = kStyles[place % std::size(kStyles)].dashes;
  return *dashes == '\0' ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes);
}

std::string mark(double x, double y, std::size_t place) {
  constexpr double r = 3.2;
  const char* outline = kOutlines[place % kColours];
  const std::string paint =
      is_hollow(place)
          ? fmt::format("fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.3\"", colour_of(place))
          : fmt::format("fill=\"{}\"", colour_of(place));
  if (*outline == '\0')
    return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" {}/>", x, y, r, paint);
  return fmt::format(
      "<path transform=\"translate({:.1f} {:.1f}) scale({})\" vector-effect=\"non-scaling-stroke\" "
      "d=\"{}\" {}/>",
      x, y, r, outline, paint);
}

}  // namespace tumble::report
