#include "framework/report/ticks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/error.h"

namespace tumble::report {
namespace {

constexpr std::size_t kLeastTicks = 3;  // numbers on an axis: fewer do not tell its scale
// Sizes of numbers that are read without a power of ten.
constexpr double kLeastPlain = 1e-3, kBeyondPlainLog = 1e4, kBeyondPlainLinear = 1e6;

double exponent_of(double tick) { return std::floor(std::log10(std::abs(tick)) + 1e-9); }

std::string with_power(double tick, double exponent) {
  if (tick == 0.0) return "0";
  return fmt::format("{:.6g}e{:.0f}", tick / std::pow(10.0, exponent), exponent);
}

struct Sizes {
  double least, largest;
};

Sizes sizes_of(const std::vector<double>& ticks) {
  Sizes sizes{std::abs(ticks.front()), std::abs(ticks.front())};
  for (const double tick : ticks) {
    sizes.least = std::min(sizes.least, std::abs(tick));
    sizes.largest = std::max(sizes.largest, std::abs(tick));
  }
  return sizes;
}

// On a linear axis the largest number decides, on a logarithmic one the smallest, too.
bool need_powers(const Sizes& sizes, Scale scale) {
  const double beyond = scale == Scale::kLog ? kBeyondPlainLog : kBeyondPlainLinear;
  return sizes.largest >= beyond * (1 - 1e-9) ||
         (scale == Scale::kLog ? sizes.least : sizes.largest) < kLeastPlain * (1 - 1e-9);
}

}  // namespace

std::vector<double> ticks_of(double low, double high, Scale scale, int most) {
  require(low < high && std::isfinite(low) && std::isfinite(high) &&
              (scale == Scale::kLinear || low > 0),
          "report: a plot's axis needs low < high");
  std::vector<double> ticks;
  if (scale == Scale::kLog && high / low >= 20) {
    const int first = static_cast<int>(std::ceil(std::log10(low) - 1e-9)),
              last = static_cast<int>(std::floor(std::log10(high) + 1e-9));
    const int stride = std::max(1, (last - first + most) / (most + 1));
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
  const double rough = (high - low) / most, power = std::pow(10.0, std::floor(std::log10(rough)));
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

std::vector<std::string> tick_words(std::vector<double> ticks, Scale scale) {
  if (ticks.empty()) return {};
  const double spacing = ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  for (double& tick : ticks)
    if (scale == Scale::kLinear && std::abs(tick) < 1e-9 * spacing) tick = 0.0;
  const Sizes sizes = sizes_of(ticks);
  const bool has_powers = sizes.largest > 0.0 && need_powers(sizes, scale);
  std::vector<std::string> words;
  for (const double tick : ticks)  // of a linear axis all have the power of the largest
    words.push_back(has_powers ? with_power(tick, scale == Scale::kLog ? exponent_of(tick)
                                                                       : exponent_of(sizes.largest))
                               : fmt::format("{:.6g}", tick));
  return words;
}

std::vector<std::string> wrapped(std::string_view words, std::size_t letters) {
  std::vector<std::string> lines;
  while (words.size() > letters) {
    std::size_t end = words.rfind(' ', letters);
    if (end == words.npos || end == 0) end = words.find(' ', 1);
    if (end == words.npos) break;
    lines.emplace_back(words.substr(0, end));
    words.remove_prefix(end + 1);
  }
  lines.emplace_back(words);
  return lines;
}

}  // namespace tumble::report
