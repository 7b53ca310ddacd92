/// Runs of a scene on ever finer steps, compared with a truth at the instant where they end.
///
/// The classical Runge-Kutta method errs by C h^4. Each halving of the step therefore tells what error is left, a fifteenth of what it
/// changed (Richardson), before any truth is looked at; and the order that is seen says whether the method is the one it claims to be.
#pragma once

#include <functional>

#include "framework/engines/truths/comparison.h"
#include "framework/engines/truths/memory_scene.h"

namespace tumble::truths {

/// What a run to some instant shows at its end, and what it should be.
struct Quantity {
  using Reading = std::function<VectorXd(const Trajectory&)>;
  using Difference = std::function<double(const VectorXd& found, const VectorXd& expected)>;

  std::string output;                  // as the truth file calls it
  Reading found;                       // of a run whose last frame is at the instant
  VectorXd expected;
  double floor = kUnset;
  bool is_state = true;                // its error shows the method's order; energies, which many methods keep better, do not
  Difference difference = largest_difference;
  /// Where the family knows it: by how much the quantity at the end answers to a rounding of the state made on the way, root of the mean
  /// square over the run of |d quantity / d state| |state| (absolute, a relative rounding of 1). Floors tell of roundings of the start
  /// only; near an unstable equilibrium those made later grow by other factors.
  double growth = 0.0;
};

/// A quantity that a case has as an output of this name.
Quantity quantity(const Case& truth, const std::string& output, Quantity::Reading found);
/// The same for something that is no part of the state.
Quantity derived(const Case& truth, const std::string& output, Quantity::Reading found);
/// The reading of a number of the last frame.
Quantity::Reading of_last_frame(std::function<double(const Frame&)> number);
Quantity::Reading vector_of_last_frame(std::function<VectorXd(const Frame&)> vector);
/// A unit quaternion as four numbers, w first.
VectorXd components(const Quaterniond& q);
/// Largest difference of two quaternions given so, of which q and -q are one orientation.
double difference_of_orientations(const VectorXd& found, const VectorXd& expected);

struct RefinedRun {
  scene::Scene scene;                  // its duration and step do not matter
  double t;                            // the instant, > 0 [s]
  std::string name;                    // of the instant, for the line about the order: "t0.5"
  double fastest_rate;                 // of the motion, roughly: what the first step is chosen by [rad/s]
  bool frames_throughout = false;      // frames close enough to follow the motion, not only the last
};

/// Halves the step until the order has settled and what a halving changes is small, though still clear of round-off, or the time for it is
/// used up. Then compares each quantity with the largest of 100 floors, the predicted truncation error and what roundings of all steps may
/// grow to (8 eps sqrt(steps) `growth`), and the order with 4.
void compare_refined(const RefinedRun& run, const Laws& laws, const std::vector<Quantity>& quantities, Comparison& comparison);

}  // namespace tumble::truths
