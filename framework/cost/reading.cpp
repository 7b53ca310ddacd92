#include "framework/cost/reading.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/text.h"

namespace tumble::cost {
namespace {

// largest deviation from the order: terms of the next order at steps this coarse
constexpr double kAsPromised = 0.25;
constexpr double kSettled = 0.5;  // slopes that differ by more show no order
constexpr double kNoOrder = 0.3;  // a slope below this is no convergence
// of a method that chooses its steps: other slopes show that the tolerance does not determine the
// cost
constexpr double kLeastSlope = 2.0, kMostSlope = 14.0;
// of the scale: errors as large as the motion have no common cause
constexpr double kStaysBelow = 0.6;
// of the scale: an error this large may come from a turn so fast that every step passes over it
constexpr double kMissesEvents = 0.01;
// of the scale: larger errors mean that the motion was not found
constexpr double kNoMotion = 0.3;
constexpr double kRoundOff = 1e-10;  // of the scale: smaller errors are round-off
// error floors: an error above this that does not decrease is wrong, not converged
constexpr double kWrongLimit = 100.0;

double least_error(const std::vector<CostResult>& results) {
  double least = std::numeric_limits<double>::infinity();
  for (const CostResult& result : results)
    if (result.stopped_by.empty() && result.error_m < least) least = result.error_m;
  return least;
}

/// Whether the last three errors are equal.
bool stays(const std::vector<CostResult>& results) {
  if (results.size() < 3) return false;
  const double last = results.back().error_m;
  return std::all_of(results.end() - 3, results.end(), [last](const CostResult& result) {
    return result.stopped_by.empty() && result.error_m <= kAlikeErrors * last &&
           last <= kAlikeErrors * result.error_m;
  });
}

/// For a method without an order because its errors are at the floor.
std::string of_exact(const CostMethod& method, double least, const CostReference& reference) {
  if (least > kRoundOff * reference.scale_m)
    return fmt::format("{} reaches the error floor of the reference solution: {} m.", method.name,
                       few_digits(least));
  return fmt::format("{} is exact here, to round-off: {} m.", method.name, few_digits(least));
}

std::string of_stopped(const CostMethod& method, const std::vector<CostResult>& results) {
  if (!results.empty() && results.back().not_attempted)
    return fmt::format("{}: {}.", method.name, results.back().stopped_by);
  return fmt::format("{} does not reach the end at any {}: {}", method.name,
                     method.controlled ? "tolerance" : "step",
                     results.empty() ? "nothing was run" : results.back().stopped_by);
}

/// For runs judged by the scene's numbers: the coarsest right resolution, and its worst number.
std::string of_numbers(const CostMethod& method, const std::vector<CostResult>& results) {
  const CostResult *best = nullptr, *coarsest = nullptr;
  for (const CostResult& result : results) {
    if (!result.stopped_by.empty() || !std::isfinite(result.error_m)) continue;
    if (best == nullptr || result.error_m < best->error_m) best = &result;
    if (coarsest == nullptr && result.error_m <= 1.0) coarsest = &result;
  }
  const CostResult* last = results.empty() ? nullptr : &results.back();
  if (best == nullptr)
    return fmt::format("{} is right at no {}: {}.", method.name,
                       method.controlled ? "tolerance" : "step",
                       last == nullptr            ? "nothing was run"
                       : last->stopped_by.empty() ? last->worst
                                                  : last->stopped_by);
  const std::string worst =
      best->worst.empty() ? "no error at all" : fmt::format("the worst number is {}", best->worst);
  if (coarsest == nullptr)
    return fmt::format("{} is wrong at every {}; at best {}.", method.name,
                       method.controlled ? "tolerance" : "step", worst);
  const std::string from = std::isfinite(coarsest->tolerance)
                               ? "tolerance " + few_digits(coarsest->tolerance)
                               : step_in_words(coarsest->step_s) + " s";
  return fmt::format("{} is right by all numbers at {}; at best {}.", method.name, from, worst);
}

std::string of_wrong_limit(const CostMethod& method, const std::vector<CostResult>& results,
                           double least, const CostReference& reference) {
  double longest = 0.0, shortest = std::numeric_limits<double>::infinity();
  for (const CostResult& result : results)
    if (result.stopped_by.empty() && result.error_m <= kAlikeErrors * least)
      longest = std::max(longest, result.step_s), shortest = std::min(shortest, result.step_s);
  const std::string over =
      longest > shortest
          ? fmt::format("from steps of {} to {} s", step_in_words(longest), step_in_words(shortest))
          : "at the finest steps";
  return fmt::format(
      "{} does not converge: its error stays at {} m {}. It computes another motion: a law is "
      "wrong, or a term of it is missing{}.",
      method.name, few_digits(least), over,
      least > kMissesEvents * reference.scale_m
          ? ", or all these steps are too long for the fastest part of the motion"
          : "");
}

std::string of_order(const CostMethod& method, const FittedOrder& fit, bool smooth) {
  const std::string seen = fmt::format("{} converges with order {:.2f}", method.name, fit.order);
  if (std::isnan(method.order)) return seen + ".";
  const double off = fit.order - method.order;
  if (std::abs(off) <= kAsPromised)
    return fmt::format("{}, as it should ({:.0f}).", seen, method.order);
  if (off > 0)
    return fmt::format("{}, better than its order {:.0f}: in this scene its leading error cancels.",
                       seen, method.order);
  if (!smooth)
    return fmt::format(
        "{} where the method has {:.0f}: here impacts, rods or contacts may determine the order, "
        "not the method.",
        seen, method.order);
  if (method.has_library_step)
    return fmt::format(
        "{} where {:.0f} is expected: the steps are the library's, so a law is wrong, or a term of "
        "it is missing.",
        seen, method.order);
  if (method.order >= 4 && fit.order > 0.6)
    return fmt::format(
        "{} where {:.0f} is expected: a stage is wrong (its weight, its time, or the slope it "
        "starts from).",
        seen, method.order);
  return fmt::format("{} where {:.0f} is expected: the step is not that of the method.", seen,
                     method.order);
}

}  // namespace

std::optional<FittedOrder> order_of(const CostMethod& method,
                                    const std::vector<CostResult>& results,
                                    const CostReference& reference) {
  std::vector<double> h, error;
  for (const CostResult& result : results) {
    h.push_back(method.controlled
                    ? 1.0 / std::max<double>(1.0, static_cast<double>(result.evaluations))
                    : result.step_s);
    error.push_back(result.stopped_by.empty() ? result.error_m : kUnset);
  }
  return method.has_refinement && !reference.by_numbers
             ? fit_order(h, error, reference.floor_m, kAnswer * reference.scale_m)
             : std::nullopt;
}

bool keeps_promise(const CostMethod& method, const std::vector<CostResult>& results,
                   const CostReference& reference) {
  const std::optional<FittedOrder> fit = order_of(method, results, reference);
  const double least = least_error(results);
  if (!fit || fit->order < kNoOrder) return least <= kWrongLimit * reference.floor_m;
  return std::isnan(method.order) || fit->order >= method.order - kAsPromised;
}

namespace {

std::string reading_of(const CostMethod& method, const std::vector<CostResult>& results,
                       const CostReference& reference, bool smooth) {
  if (reference.by_numbers) return of_numbers(method, results);
  const double least = least_error(results);
  const std::string shown = few_digits(least);
  if (!std::isfinite(least)) return of_stopped(method, results);
  if (!method.has_refinement && least <= reference.floor_m)
    return fmt::format(
        "{} has no step to choose: its error is at the floor of the reference solution.",
        method.name);
  if (!method.has_refinement)
    return fmt::format("{} has no step to choose: its error is {} m.", method.name, shown);
  const std::optional<FittedOrder> fit = order_of(method, results, reference);
  if (!fit && method.controlled) return fmt::format("{} gets to {} m.", method.name, shown);
  if (!fit && least <= kWrongLimit * reference.floor_m) return of_exact(method, least, reference);
  if (!method.controlled && stays(results) && least > kWrongLimit * reference.floor_m &&
      least < kStaysBelow * reference.scale_m)
    return of_wrong_limit(method, results, least, reference);
  if (!fit && least > kNoMotion * reference.scale_m)
    return fmt::format(
        "{} does not find the motion: its error is still {} m at the finest {}, where bodies "
        "move {} m. Either a law is wrong, or the steps are far too long.",
        method.name, shown, method.controlled ? "tolerance" : "step",
        few_digits(reference.scale_m));
  if (!fit)
    return fmt::format("{} shows no order yet: its error is still {} m where bodies move {} m.",
                       method.name, shown, few_digits(reference.scale_m));
  if (method.controlled && (fit->order < kLeastSlope || fit->order > kMostSlope))
    return fmt::format("{} gets to {} m.", method.name, shown);
  if (method.controlled)
    return fmt::format("{} gets to {} m; ten times the evaluations divide its error by 10^{:.1f}.",
                       method.name, shown, fit->order);
  if (fit->order < kNoOrder && least <= kWrongLimit * reference.floor_m)
    return of_exact(method, least, reference);
  if (fit->pairs < kPairsOfAnOrder)
    return fmt::format("{} gets to {} m; too few resolutions to show an order.", method.name,
                       shown);
  if (fit->order < kNoOrder && least > kWrongLimit * reference.floor_m)
    return of_wrong_limit(method, results, least, reference);
  if (fit->spread > kSettled)
    return fmt::format("{} gets to {} m; its order has not settled ({:.1f}, slopes {:.1f} apart).",
                       method.name, shown, fit->order, fit->spread);
  return of_order(method, *fit, smooth);
}

}  // namespace

std::string read_refinement(const CostMethod& method, const std::vector<CostResult>& results,
                            const CostReference& reference, bool smooth) {
  const std::string text = reading_of(method, results, reference, smooth);
  return capitalised(text.starts_with("reference ") ? "the " + text : text);
}

}  // namespace tumble::cost
