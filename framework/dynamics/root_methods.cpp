#include "framework/dynamics/root_methods.h"

#include <algorithm>
#include <cmath>

#include <boost/math/tools/roots.hpp>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/core/numbers.h"

namespace tumble {
namespace {

constexpr std::uintmax_t kMostIterations = 200;

struct Found {
  double time;
  bool converged;  // not ended by kMostIterations
};

/// What every finder does first: a bracket that is none is said to be none.
template <class Search>
RootResult in_bracket(const ScalarFunction& gap, double low, double high, const Search& search) {
  RootResult result;
  const auto counted = [&](double t) {
    ++result.evaluations;
    return gap(t);
  };
  const double at_low = counted(low), at_high = counted(high);
  if (std::isnan(at_low) || std::isnan(at_high)) return result;
  result.status = RootStatus::kNoSignChange;
  if (at_low < 0.0 || (at_low > 0.0 && at_high > 0.0)) return result;
  result.status = RootStatus::kConverged;
  result.time = at_low == 0.0 ? low : high;
  if (at_low != 0.0 && at_high != 0.0) {
    const Found found = search(counted);
    result.time = found.time;
    if (!found.converged) result.status = RootStatus::kNotConverged;
  }
  result.residual = gap(result.time);
  return result;
}

RootResult bisect(const ScalarFunction& gap, const ScalarFunction&, double low, double high,
                  double tolerance) {
  return in_bracket(gap, low, high, [&](const auto& counted) {
    std::uintmax_t most = kMostIterations;
    const auto close = [tolerance](double a, double b) { return std::abs(b - a) <= tolerance; };
    const auto [a, b] = boost::math::tools::bisect(counted, low, high, close, most);
    // on the side where the gap has not closed yet; no bracket is smaller than neighbouring doubles
    return Found{a, close(a, b) || std::nextafter(a, b) == b};
  });
}

RootResult newton(const ScalarFunction& gap, const ScalarFunction& rate, double low, double high,
                  double tolerance) {
  return in_bracket(gap, low, high, [&](const auto& counted) {
    std::uintmax_t most = kMostIterations;
    const auto both = [&](double t) { return std::make_pair(counted(t), rate(t)); };
    // Boost stops where a step is below 2^(1 - bits) of the place itself.
    const double part =
        std::clamp(tolerance / std::max(std::abs(high), tolerance), std::ldexp(1.0, -52), 0.5);
    const double time = boost::math::tools::newton_raphson_iterate(
        both, 0.5 * (low + high), low, high,
        std::max(1, static_cast<int>(std::lround(1.0 - std::log2(part)))), most);
    if (most < kMostIterations) return Found{time, true};  // as many as it took
    // to and fro by roundings, or not there yet: the gap's sign tells
    const double near = std::max(tolerance, 8 * kEpsilon * std::abs(time));
    return Found{time, counted(std::max(low, time - near)) >= 0.0 &&
                           counted(std::min(high, time + near)) <= 0.0};
  });
}

}  // namespace

const std::vector<RootMethod>& root_methods() {
  static const std::vector<RootMethod> all = {
      {"bisection", "bisection", bisect},
      {"newton", "Newton, safeguarded", newton},
      {"toms748", "TOMS 748", library_laws().find_impact_time}};
  return all;
}

const RootMethod& root_method_named(const std::string& word) {
  std::vector<std::string> words;
  std::string known;
  for (const RootMethod& method : root_methods()) {
    if (method.word == word) return method;
    words.push_back(method.word);
    known += (known.empty() ? "" : ", ") + method.word;
  }
  throw UserError("root finder '" + word + "'",
                  "there is none of that name." + did_you_mean(word, words),
                  "Known: " + known + ".");
}

}  // namespace tumble
