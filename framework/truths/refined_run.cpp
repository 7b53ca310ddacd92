#include "framework/truths/refined_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/scene/words.h"

namespace tumble::truths {
namespace {

// rad: largest angle of the fastest motion in the first run's step
constexpr double kFirstAngle = 0.2;
// rad: largest phase error of an oscillation in the first run, (w h)^4 / 120 w t
constexpr double kFirstError = 1e-2;
constexpr long kFewestSteps = 16;
// of all runs to one time together, beyond the first three: seconds
constexpr double kMostSteps = 8e4;
// allowance for the terms after C h^4 in a prediction
constexpr double kNextTerm = 2.0;
// a smaller deviation from the order of the first runs is not reported
constexpr double kUnsettled = 0.5;
// Changes in floors. Thousands of steps, each with tens of roundings, may add up to some thousand
// floors.
// small enough: about 1e-10 of the compared value
constexpr double kFine = 1e6;
// known to a few per cent, its log2 to less than the order's tolerance
constexpr double kAboveRoundOff = 1e5;
// of two runs' round-off: one may be larger than their difference by this factor
constexpr double kChance = 3.0;
// Roundings per step of RK4 in each number of the state: four stages, their sum, the projection
// onto rods and joints; half an eps each, of equal or different sign, and three standard deviations
// of their sum over the steps.
constexpr double kRoundingsAStep = 8.0;
// of a quantity's size: with a larger predicted error a wrong value would pass
constexpr double kTellsNothing = 1e-3;

using Readings = std::vector<VectorXd>;

/// All quantities at the end of a run of `steps` equal steps.
Readings read(const RefinedRun& run, const Laws& laws, const std::vector<Quantity>& quantities,
              long frames, long steps) {
  const Trajectory trajectory = run_in_steps(run.scene, laws, run.t, steps, frames);
  Readings readings;
  for (const Quantity& quantity : quantities) readings.push_back(quantity.found(trajectory));
  return readings;
}

struct Level {
  long steps = 0;
  Readings readings;
  std::vector<double> changes;  // by the last halving
  // of all quantities of the state, in floors: root of the sum of squares
  double state_change = kUnset;
};

/// 0 where a floor of 0 says that the value is exact.
double in_floors(double change, double floor) { return floor > 0.0 ? change / floor : 0.0; }

Level next_level(const Level& last, Readings readings, const std::vector<Quantity>& quantities) {
  Level level{2 * last.steps, std::move(readings), {}, 0.0};
  double squares = 0.0;
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    level.changes.push_back(quantities[i].difference(level.readings[i], last.readings[i]));
    if (quantities[i].is_state)
      squares += std::pow(in_floors(level.changes[i], quantities[i].error_floor), 2);
  }
  level.state_change = std::sqrt(squares);
  return level;
}

/// Remaining error of quantity i at the finest level: a fifteenth of the last change, or 1 / (2^p -
/// 1) of it where changes still decrease with order p < 4. Where the last change happens to cross
/// zero, the changes before it are used, reduced by the same factor for each level.
double truncation(const std::vector<Level>& levels, std::size_t i) {
  const Level &last = levels.back(), &before = levels[levels.size() - 2];
  const double shrinks = last.state_change > kAboveRoundOff
                             ? std::clamp(before.state_change / last.state_change, 2.0, 16.0)
                             : 16.0;
  double change = std::max(last.changes[i], before.changes[i] / shrinks);
  if (levels.size() > 3)
    change = std::max(change, levels[levels.size() - 3].changes[i] / (shrinks * shrinks));
  return kNextTerm * change / (shrinks - 1.0);
}

/// The order of the finest change above round-off, and whether the one before agrees.
struct Order {
  double value = kUnset;
  long steps = 0;
  bool settled = false;
};

Order order_of(const std::vector<Level>& levels) {
  for (std::size_t k = levels.size() - 1; k >= 2; --k) {
    if (levels[k].state_change <= kAboveRoundOff) continue;
    const double order = std::log2(levels[k - 1].state_change / levels[k].state_change);
    const double last =
        k >= 3 ? std::log2(levels[k - 2].state_change / levels[k - 1].state_change) : kUnset;
    return {order, levels[k].steps, std::abs(order - last) <= kSettled};
  }
  return {};
}

/// Round-off of the states of the finest runs, in floors, from a run with slightly shorter steps.
/// Computed only where halving the step changed so little, or so irregularly, that round-off may be
/// part of it (near a saddle it grows beyond the floors, which only vary the start).
double round_off(const RefinedRun& run, const Laws& laws, const std::vector<Quantity>& quantities,
                 const std::vector<Level>& levels, long frames) {
  const Level& finest = levels.back();
  const Order order = order_of(levels);
  // after many halvings round-off alone may show an order of 4 by chance
  const bool agrees = levels.size() <= 3 || order.settled;
  const bool is_clear = finest.state_change > kAboveRoundOff &&
                        std::abs(order.value - kOrder) <= kOrderTolerance && agrees;
  if (is_clear || !std::isfinite(finest.state_change)) return 0.0;
  const Readings shifted = read(run, laws, quantities, frames, finest.steps + frames);
  double squares = 0.0;
  for (std::size_t i = 0; i < quantities.size(); ++i)
    if (quantities[i].is_state)
      squares += std::pow(in_floors(quantities[i].difference(shifted[i], finest.readings[i]),
                                    quantities[i].error_floor),
                          2);
  return kChance * std::sqrt(squares);
}

bool is_fine_enough(const std::vector<Level>& levels) {
  if (levels.size() < 3) return false;
  const double change = levels.back().state_change;
  return change <= kAboveRoundOff || (change <= kFine && order_of(levels).settled);
}

struct Refinement {
  std::vector<Level> levels;
  double round_off;  // of the finest, in floors
};

Refinement refine(const RefinedRun& run, const Laws& laws,
                  const std::vector<Quantity>& quantities) {
  const double turned = run.t * run.fastest_rate,
               angle = std::min(kFirstAngle, std::pow(120.0 * kFirstError / turned, 0.25));
  const long first = std::max(kFewestSteps, static_cast<long>(std::ceil(turned / angle))),
             frames = run.frames_throughout ? first : 1;
  std::vector<Level> levels{{first, read(run, laws, quantities, frames, first),
                             std::vector<double>(quantities.size(), kUnset), kUnset}};
  double spent = static_cast<double>(first);
  while (!is_fine_enough(levels)) {
    const long steps = 2 * levels.back().steps;
    spent += static_cast<double>(steps);
    if (levels.size() >= 3 && spent > kMostSteps) break;
    levels.push_back(
        next_level(levels.back(), read(run, laws, quantities, frames, steps), quantities));
    if (!std::isfinite(levels.back().state_change)) break;
  }
  const double rounding = round_off(run, laws, quantities, levels, frames);
  return {std::move(levels), rounding};
}

void compare_order(const RefinedRun& run, const std::vector<Level>& levels,
                   Comparison& comparison) {
  const std::string output = "rk4.order_" + run.name;
  const Order order = order_of(levels);
  const double error = std::abs(order.value - kOrder);
  if (order.steps == 0)
    comparison.not_compared(output, "round-off hides the order");
  else if (order.value > kOrder + kOrderTolerance)
    comparison.not_compared(
        output, fmt::format("order {:.3f} at {} steps: terms beyond h^4 outweigh it", order.value,
                            order.steps));
  else if (error > kOrderTolerance && !order.settled && (levels.size() > 3 || error <= kUnsettled))
    comparison.not_compared(output, fmt::format("the order has not settled: {:.3f} at {} steps",
                                                order.value, order.steps));
  else
    comparison.check(
        output, error, kUnset, kOrderTolerance,
        fmt::format("order {:.3f} on halving the step to {} steps", order.value, order.steps));
}

}  // namespace

Quantity quantity(const Case& truth, const std::string& output, Quantity::Reading found) {
  const Value& value = truth.output(output);
  return {output, std::move(found),
          value.is_list() ? value.vector() : VectorXd::Constant(1, value.number()),
          truth.floor(output)};
}

Quantity derived(const Case& truth, const std::string& output, Quantity::Reading found) {
  Quantity made = quantity(truth, output, std::move(found));
  made.is_state = false;
  return made;
}

Quantity::Reading of_last_frame(std::function<double(const Frame&)> number) {
  return [number = std::move(number)](const Trajectory& run) -> VectorXd {
    return VectorXd::Constant(1, number(run.frames.back()));
  };
}

Quantity::Reading vector_of_last_frame(std::function<VectorXd(const Frame&)> vector) {
  return [vector = std::move(vector)](const Trajectory& run) -> VectorXd {
    return vector(run.frames.back());
  };
}

VectorXd components(const Quaterniond& q) { return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()); }

double difference_of_orientations(const VectorXd& found, const VectorXd& expected) {
  if (found.size() != 4) return kUnset;
  return quaternion_difference(Quaterniond(found[0], found[1], found[2], found[3]), expected);
}

namespace {

void compare_in_its_coordinates(const RefinedRun& run, const Laws& laws,
                                const std::vector<Quantity>& quantities, Comparison& comparison) {
  const auto [levels, round_off] = refine(run, laws, quantities);
  compare_order(run, levels, comparison);
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    const Quantity& q = quantities[i];
    const double error = q.difference(levels.back().readings[i], q.expected),
                 predicted = truncation(levels, i),
                 on_the_way = kRoundingsAStep * std::numeric_limits<double>::epsilon() *
                              std::sqrt(static_cast<double>(levels.back().steps)) * q.growth,
                 rounding =
                     std::max(std::max(kClosedFormFactor, round_off) * q.error_floor, on_the_way);
    std::string note = fmt::format("predicted truncation error {:.1e} of {} steps", predicted,
                                   levels.back().steps);
    if (on_the_way >= rounding)
      note += fmt::format(", rounding of all steps grows to {:.1e}", on_the_way);
    else if (round_off > kClosedFormFactor)
      note += fmt::format(", round-off {:.1e}", rounding);
    double size = q.expected.size() > 0 ? q.expected.cwiseAbs().maxCoeff() : 0.0;
    for (const Level& level : levels)
      size = std::max(size,
                      level.readings[i].size() > 0 ? level.readings[i].cwiseAbs().maxCoeff() : 0.0);
    if (predicted > rounding && predicted > kTellsNothing * size) {
      comparison.check(q.output, kUnset, q.error_floor, rounding,
                       note + ": too large to tell right from wrong");
      continue;
    }
    comparison.check(q.output, error, q.error_floor, rounding + predicted, note);
  }
}

}  // namespace

void compare_refined(const RefinedRun& run, const Laws& laws,
                     const std::vector<Quantity>& quantities, Comparison& comparison) {
  compare_in_its_coordinates(run, laws, quantities, comparison);
  if (!scene::is_constrained(run.scene)) return;
  // The same without rows: what is linked in the coordinates that its rods and joints leave free.
  const std::string suffix = " in joint coordinates";
  RefinedRun in_joints = run;
  in_joints.scene.coordinates = scene::Coordinates::kReduced;
  in_joints.name += suffix;
  std::vector<Quantity> again = quantities;
  // Momenta are read and written at each step's ends, where angular velocity is integrated: each
  // step rounds the state by as much as it is large, which stays where nothing makes it grow.
  for (Quantity& quantity : again) {
    quantity.output += suffix;
    if (quantity.expected.size() > 0)
      quantity.growth = std::max(quantity.growth, quantity.expected.cwiseAbs().maxCoeff());
  }
  compare_in_its_coordinates(in_joints, laws, again, comparison);
}

}  // namespace tumble::truths
