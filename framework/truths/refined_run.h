/// Runs of a scene with successively halved steps, compared with reference values at the end time.
///
/// The error of the classical Runge-Kutta method is C h^4. So each halving of the step predicts the
/// remaining error, a fifteenth of the change (Richardson), without reference values; and the
/// observed order shows whether the method is the one it claims to be.
#pragma once

#include <functional>

#include "framework/truths/comparison.h"
#include "framework/truths/memory_scene.h"

namespace tumble::truths {

/// A quantity at the end of a run, and its expected value.
struct Quantity {
  using Reading = std::function<VectorXd(const Trajectory&)>;
  using Difference = std::function<double(const VectorXd& found, const VectorXd& expected)>;

  std::string output;  // its name in the file of reference values
  Reading found;       // of a run whose last frame is at the end time
  VectorXd expected;
  double error_floor = kUnset;
  // its error shows the method's order; energies, which many methods conserve better, do not
  bool is_state = true;
  Difference difference = largest_difference;
  /// Where the family knows it: the change of the quantity at the end by rounding of the state
  /// during the run, root mean square over the run of |d quantity / d state| |state| (absolute, for
  /// a relative rounding of 1). Floors account for rounding of the start only; near an unstable
  /// equilibrium later rounding grows by other factors.
  double growth = 0.0;
};

/// A quantity that is an output of the case.
Quantity quantity(const Case& truth, const std::string& output, Quantity::Reading found);
/// The same for a quantity that is not part of the state.
Quantity derived(const Case& truth, const std::string& output, Quantity::Reading found);
/// Reads a number of the last frame.
Quantity::Reading of_last_frame(std::function<double(const Frame&)> number);
Quantity::Reading vector_of_last_frame(std::function<VectorXd(const Frame&)> vector);
/// A unit quaternion as four numbers, w first.
VectorXd components(const Quaterniond& q);
/// Largest difference of two such quaternions; q and -q are one orientation.
double difference_of_orientations(const VectorXd& found, const VectorXd& expected);

struct RefinedRun {
  scene::Scene scene;   // its duration and step are not used
  double t;             // the end time, > 0 [s]
  std::string name;     // of the end time, for the line about the order: "t0.5"
  double fastest_rate;  // of the motion, roughly: determines the first step [rad/s]
  // frames dense enough to follow the motion, not only the last
  bool frames_throughout = false;
};

/// Halves the step until the order has settled and the change by a halving is small, though still
/// above round-off, or the time limit is reached. Then compares each quantity with a tolerance, the
/// predicted truncation error and the largest of 100 floors, the round-off found, and the growth
/// of the rounding of all steps (8 eps sqrt(steps) `growth`), and the order with 4. Scenes of rods
/// and joints run twice, in six coordinates a body and in joint coordinates, each with lines of
/// its own.
void compare_refined(const RefinedRun& run, const Laws& laws,
                     const std::vector<Quantity>& quantities, Comparison& comparison);

}  // namespace tumble::truths
