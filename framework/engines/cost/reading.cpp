#include "framework/engines/cost/reading.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace tumble::engines {
namespace {

constexpr double kAsPromised = 0.25;     // off the order by less: terms of the next order at steps this coarse
constexpr double kSettled = 0.5;         // slopes that lie farther apart show no order
constexpr double kNoOrder = 0.3;         // a slope below this is no convergence
constexpr double kLeastSlope = 2.0, kMostSlope = 14.0;   // of a method that chooses its steps: others show that the tolerance was not what cost
constexpr double kStaysBelow = 0.6;      // of the scale: errors as large as bodies move are alike whatever made them
constexpr double kNoMotion = 0.3;        // of the scale: whoever stays above it has not found the motion
constexpr double kSame = 0.02;           // errors that differ by less are one
constexpr double kRoundOff = 1e-10;       // of the scale: smaller errors are
constexpr double kWrongLimit = 100.0;    // floors: what does not shrink above this is wrong, not finished

double least_error(const std::vector<CostRung>& rungs) {
  double least = std::numeric_limits<double>::infinity();
  for (const CostRung& rung : rungs)
    if (rung.stopped_by.empty() && rung.error_m < least) least = rung.error_m;
  return least;
}

/// Whether the last three errors are the same.
bool stays(const std::vector<CostRung>& rungs) {
  if (rungs.size() < 3) return false;
  const double last = rungs.back().error_m;
  return std::all_of(rungs.end() - 3, rungs.end(), [last](const CostRung& rung) { return rung.stopped_by.empty() && std::abs(rung.error_m - last) <= kSame * last; });
}

/// Of what shows no order because nothing is left to show.
std::string of_exact(const CostWay& way, double least, const CostTruth& truth) {
  if (least > kRoundOff * truth.scale_m) return fmt::format("{} gets as close as the truth can tell: {:.1e} m.", way.name, least);
  return fmt::format("{} is exact here, to round-off: {:.1e} m.", way.name, least);
}

std::string of_stopped(const CostWay& way, const std::vector<CostRung>& rungs) {
  if (!rungs.empty() && rungs.back().not_attempted) return fmt::format("{}: {}.", way.name, rungs.back().stopped_by);
  return fmt::format("{} does not get through at any {}: {}", way.name, way.controlled ? "tolerance" : "step", rungs.empty() ? "nothing was run" : rungs.back().stopped_by);
}

/// Runs judged by the scene's numbers: from which step on, and by how much.
std::string of_numbers(const CostWay& way, const std::vector<CostRung>& rungs) {
  const CostRung *best = nullptr, *coarsest = nullptr;
  for (const CostRung& rung : rungs) {
    if (!rung.stopped_by.empty() || !std::isfinite(rung.error_m)) continue;
    if (best == nullptr || rung.error_m < best->error_m) best = &rung;
    if (coarsest == nullptr && rung.error_m <= 1.0) coarsest = &rung;
  }
  const CostRung* last = rungs.empty() ? nullptr : &rungs.back();
  if (best == nullptr) return fmt::format("{} is right at no {}: {}.", way.name, way.controlled ? "tolerance" : "step", last == nullptr ? "nothing was run" : last->stopped_by.empty() ? last->worst : last->stopped_by);
  const std::string worst = best->worst.empty() ? "nothing is used up of what is allowed" : fmt::format("the worst number is {}", best->worst);
  if (coarsest == nullptr) return fmt::format("{} is wrong at every {}; at best {}.", way.name, way.controlled ? "tolerance" : "step", worst);
  const std::string from = std::isfinite(coarsest->tolerance) ? fmt::format("tolerance {:.0e}", coarsest->tolerance) : fmt::format("1/{:.0f} s", 1.0 / coarsest->step_s);
  return fmt::format("{} is right by all numbers at {}; at best {}.", way.name, from, worst);
}

std::string of_wrong_limit(const CostWay& way, double least) {
  return fmt::format("{} does not converge: its error stays at {:.1e} m however small the step. What it computes is not this motion (a wrong law, or a term left out).", way.name, least);
}

std::string of_order(const CostWay& way, const FittedOrder& fit, bool smooth) {
  const std::string seen = fmt::format("{} converges with order {:.2f}", way.name, fit.order);
  if (std::isnan(way.order)) return seen + ".";
  const double off = fit.order - way.order;
  if (std::abs(off) <= kAsPromised) return fmt::format("{}, as it should ({:.0f}).", seen, way.order);
  if (off > 0) return fmt::format("{}, better than the {:.0f} it promises: in this scene its leading error cancels.", seen, way.order);
  if (!smooth) return fmt::format("{} where the method promises {:.0f}: here impacts, rods or contacts may set the order, not the method.", seen, way.order);
  if (way.order >= 4 && fit.order > 0.6) return fmt::format("{} where {:.0f} is promised: a stage is off (its weight, its place in time, or the slope it starts from).", seen, way.order);
  return fmt::format("{} where {:.0f} is promised: the step is not the method's.", seen, way.order);
}

}  // namespace

std::optional<FittedOrder> order_of(const CostWay& way, const std::vector<CostRung>& rungs, const CostTruth& truth) {
  std::vector<double> h, error;
  for (const CostRung& rung : rungs) {
    h.push_back(way.controlled ? 1.0 / std::max<double>(1.0, static_cast<double>(rung.evaluations)) : rung.step_s);
    error.push_back(rung.stopped_by.empty() ? rung.error_m : kUnset);
  }
  return way.has_ladder && !truth.by_numbers ? fit_order(h, error, truth.floor_m, kAnswer * truth.scale_m) : std::nullopt;
}

bool keeps_promise(const CostWay& way, const std::vector<CostRung>& rungs, const CostTruth& truth) {
  const std::optional<FittedOrder> fit = order_of(way, rungs, truth);
  const double least = least_error(rungs);
  if (!fit || fit->order < kNoOrder) return least <= kWrongLimit * truth.floor_m;
  return std::isnan(way.order) || fit->order >= way.order - kAsPromised;
}

std::string read_ladder(const CostWay& way, const std::vector<CostRung>& rungs, const CostTruth& truth, bool smooth) {
  if (truth.by_numbers) return of_numbers(way, rungs);
  const double least = least_error(rungs);
  if (!std::isfinite(least)) return of_stopped(way, rungs);
  if (!way.has_ladder && least <= truth.floor_m) return fmt::format("{} has no step to choose: it is as good as the truth.", way.name);
  if (!way.has_ladder) return fmt::format("{} has no step to choose: it is off by {:.1e} m.", way.name, least);
  const std::optional<FittedOrder> fit = order_of(way, rungs, truth);
  if (!fit && way.controlled) return fmt::format("{} gets to {:.1e} m.", way.name, least);
  if (!fit && least <= kWrongLimit * truth.floor_m) return of_exact(way, least, truth);
  if (!way.controlled && stays(rungs) && least > kWrongLimit * truth.floor_m && least < kStaysBelow * truth.scale_m) return of_wrong_limit(way, least);
  if (!fit && least > kNoMotion * truth.scale_m) return fmt::format("{} does not find the motion: its error is still {:.1e} m at the finest {}, where bodies move {:.1e} m. Either a law is wrong, or the steps are far too long.", way.name, least, way.controlled ? "tolerance" : "step", truth.scale_m);
  if (!fit) return fmt::format("{} shows no order yet: its error is still {:.1e} m where bodies move {:.1e} m.", way.name, least, truth.scale_m);
  if (way.controlled && (fit->order < kLeastSlope || fit->order > kMostSlope)) return fmt::format("{} gets to {:.1e} m.", way.name, least);
  if (way.controlled) return fmt::format("{} gets to {:.1e} m; each ten times the evaluations divide its error by 10^{:.1f}.", way.name, least, fit->order);
  if (fit->order < kNoOrder && least <= kWrongLimit * truth.floor_m) return of_exact(way, least, truth);
  if (fit->pairs < 2) return fmt::format("{} gets to {:.1e} m; its ladder is too short to show an order.", way.name, least);
  if (fit->order < kNoOrder && least > kWrongLimit * truth.floor_m)
    return of_wrong_limit(way, least);
  if (fit->spread > kSettled) return fmt::format("{} gets to {:.1e} m; its order has not settled ({:.1f}, slopes {:.1f} apart).", way.name, least, fit->order, fit->spread);
  return of_order(way, *fit, smooth);
}

}  // namespace tumble::engines
