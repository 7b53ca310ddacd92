/// Whether a step is within the range in which the laws' method can follow a world: what draws its
/// bodies back or slows them down, Baumgarte's term, light bodies on rods.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/dynamics/world.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/stepping/link_forces.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// By how much a step of the method lengthens the swing of  y'' = -w^2 y - c y'  (spectral radius
/// of the step's matrix, 1: not at all), found by asking the method itself. Source: E. Hairer, G.
/// Wanner, "Solving ODEs II", IV.2.
double amplification(const Laws& laws, double angular_frequency, double damping, double step);

/// Largest step up to `step` that does not lengthen the same swing; 0 where none does not, down to
/// a thousandth of its faster rate. [s]
double largest_stable_step(const Laws& laws, double angular_frequency, double damping, double step);

struct SpringStability {
  // what takes most part in the fastest swing, in words: "spring 'a'"
  std::string of;
  double angular_frequency;  // of that swing where the run starts [rad/s]
  double damping;            // c of  y'' = -w^2 y - c y'  for it [1/s]
  double amplification;      // a step
  double largest_step;       // that does not lengthen it [s]; 0 where none does not

  std::string remedy, last_remedy;  // beside a shorter step; where no step does

  // no swing: its damper's matter
  bool is_overdamped() const { return damping > 2.0 * angular_frequency; }
};

/// The fastest swing of what draws the bodies of a world back where it starts (springs), along
/// these directions, with what rods and joints hold kept still: the eigenvalues of J N J^T K, where
/// N is M^-1 without the directions that rods and joints do not allow.
/// @return nothing for a world in which nothing does. Where more than 60 bodies are linked, springs
/// on bodies that rods or joints
///         hold are not judged
std::optional<SpringStability> judge_springs(const World& world, const Laws& laws, double step);

/// Of anything else that limits a step.
struct StepLimit {
  std::string of;        // in words, with the name
  double amplification;  // of what should die away, a step
  double largest_step;   // that does not lengthen it [s]; 0 where none does not
  std::string remedy;    // beside a shorter step
};

/// The way of moving from which the dampers of the world's springs take most (the largest
/// eigenvalue of J N J^T C), with what the springs do to it. Where it swings, `judge_springs`
/// speaks of it.
/// @return nothing where the method follows it; the same are not judged
std::optional<StepLimit> judge_dampers(const World& world, const Laws& laws, double step);

/// What effects take evenly from a body's velocities (effects::Drain), y' = -c/m y and -c/I y (the
/// least moment), and what Baumgarte's term takes from errors of rods and joints, e'' = -k e - c e'
/// with the laws' own gains. Those that the method lengthens at this step.
std::vector<StepLimit> judge_decays(const World& world, const Laws& laws, double step);

/// The fastest swing of bodies across rods that pull: M x'' = -K x, K = sum of (tension / length)
/// (1 - n n^T), where the rods keep their lengths. A light body between a ceiling and a heavy one
/// has the highest: about sqrt(M g (1/l1 + 1/l2) / m).
/// @param carriers  of the world: those that keep a length are its rods
/// @param loads  by carrier: their tensions [N] Of more than a hundred bodies the hundred that are
/// held hardest are looked at, the others kept still: a lower bound of the fastest swing. The
/// largest step comes from an upper bound then.
/// @return nothing where the method does not lengthen it, and where rods end beside centres of mass
/// or joints are there too: such worlds are not judged
std::optional<StepLimit> judge_rods(const World& world,
                                    const std::vector<effects::Carrier>& carriers,
                                    const std::vector<double>& loads, const Laws& laws,
                                    double step);

/// What carries in a world, rods and joints: in the order of effects and their entries.
struct Carriers {
  explicit Carriers(const World& world);

  std::vector<effects::Carrier> all;
  std::vector<std::size_t> effect;  // by carrier: its effect's place in effects::all()
};

/// What they carry. [N]
struct LinkLoads {
  std::vector<double> loads;  // by carrier
  // some hangs loose first, or carries more by what has fallen than by what hangs on it: it comes
  // taut with a jerk
  bool by_falling = false;
};

/// About the most that each will carry in a run by gravity and what moves at the start: the weight
/// below it, and what turns that round where it has fallen as far as its links let it. 0 for links
/// of which none leads to anything that does not move.
LinkLoads largest_link_loads(const World& world, const std::vector<effects::Carrier>& carriers);

/// The fastest swing of bodies between joints that carry these loads, an upper bound: w^2 = max sum
/// of load times arm / moment of inertia.
/// @return nothing where the method does not lengthen it
std::optional<StepLimit> judge_joints(const World& world,
                                      const std::vector<effects::Carrier>& carriers,
                                      const std::vector<double>& loads, const Laws& laws,
                                      double step);

struct StepsOfARun {
  double step, duration;  // [s]
};

/// Where a refusal of a run's step points: at the scene's "step_s" where the step is from there.
std::string place_of_step(const scene::Scene& scene, double step);

/// Refuses a run in which the method would lengthen a thousand times what effects or Baumgarte's
/// term take part in; reports one where it can be seen. Reports what is driven to and fro by more
/// than a radian a step, where others feel it by more than impacts.
/// @throws UserError naming the effect, the body or the term, what happens to it and the largest
/// step that does not do it
void refuse_unstable_steps(const World& world, const Laws& laws, const StepsOfARun& steps,
                           const std::string& where, std::vector<std::string>& notices);

/// Reports rods and joints whose bodies swing too fast for the step of a method that has a range,
/// with the step that follows them all through the run. Not refused: what hangs straight does not
/// swing.
/// @param at_start  what rods and joints pull with where the run starts
/// @return that step, where one is reported [s]
std::optional<double> report_unstable_links(const World& world, const LinkForces& at_start,
                                            const Laws& laws, const StepsOfARun& steps,
                                            std::vector<std::string>& notices);

}  // namespace tumble::engines
