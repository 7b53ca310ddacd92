/// Whether a step is within the range in which the laws' method can follow a world's springs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/dynamics/world.h"

namespace tumble::engines {

/// By how much a step of the method lengthens the swing of  y'' = -w^2 y - c y'  (spectral radius of the step's matrix, 1: not at all),
/// found by asking the method itself. Source: E. Hairer, G. Wanner, "Solving ODEs II", IV.2.
double amplification(const Laws& laws, double angular_frequency, double damping, double step);

struct SpringStability {
  std::string spring;              // the one that takes most part in the fastest swing
  double angular_frequency;        // of that swing where the run starts [rad/s]
  double amplification;            // a step
  double largest_step;             // that does not lengthen it [s]; 0 where none does not
};

/// The fastest swing of the springs of a world where it starts (along the springs; the eigenvalues of J M^-1 J^T K).
/// @return nothing for a world without springs
std::optional<SpringStability> judge_springs(const World& world, const Laws& laws, double step);

struct StepsOfARun {
  double step, duration;           // [s]
};

/// Refuses a run in which the method would lengthen a swing of the springs a thousand times; tells of one where it can be seen.
/// @throws UserError naming the spring, what happens to it and the largest step that does not do it
void refuse_unstable_springs(const World& world, const Laws& laws, const StepsOfARun& steps, const std::string& where, std::vector<std::string>& notices);

/// Looks on while a world moves: energy that nothing can have brought in is the method's, or a wrong law's.
class EnergyWatch {
 public:
  /// @return what has run away, in words, with the body that has most of it; nothing while all is well, and for worlds that are driven
  ///         (point forces, motors, moving walls)
  std::optional<std::string> look(const World& world, const std::vector<RigidBodyState>& states);

 private:
  double first_energy_ = kUnset, scale_ = 0.0, first_potential_ = 0.0, lowest_potential_ = 0.0;   // [J]
};

/// What a run says that ends because of it. @param runaway  as the watch put it
std::string told_runaway(double time, const std::string& runaway, const Laws& laws);

}  // namespace tumble::engines
