/// Judges a recorded run by numbers: what the scene's `checks` ask. Reads scene and trajectory, never an engine.
///
/// | kind             | value                                                                 | right when                 |
/// | energy           | largest |E - E0| over what there was to begin with (below) [-]        | <= tolerance               |
/// | energy_not_rising| largest rise of E above an earlier value, over the same [-]           | <= tolerance               |
/// | momentum         | largest |P - P0| [kg m/s]; with `expected`: |P - expected| at the end  | <= tolerance               |
/// | angular_momentum | the same for L about the world's origin [kg m^2/s]                    | <= tolerance               |
/// | gap              | smallest gap of any frame [m]                                         | >= -tolerance              |
/// | final_position   | distance of body's centre from `expected` at `at_s` [m]               | <= tolerance               |
/// | final_velocity   | the same for its velocity [m/s]                                       | <= tolerance               |
/// | impact_times     | largest error of the first impacts of `body` and `other` [s]          | <= tolerance               |
/// | event_count      | |collisions - expected|, of `body` and `other` where named [-]        | <= tolerance               |
/// | restitution_law  | largest |v_after + e v_before| over |v_before|, of all collisions [-] | <= tolerance               |
/// | side_of_wall     | smallest distance of body from other's centre along `axis` (world), on the side where it began [m] | >= -tolerance |
/// | flips            | |flips - expected|: how often the body's own `axis` turned over against where it pointed first [-]  | <= tolerance |
///
/// Energies are compared with the kinetic energy at `at_s` plus the deepest fall of the potential energy below its value there:
/// what a run makes from nothing is not in it, so that it cannot widen its own pass mark.
/// For energy, momentum and angular momentum `at_s` is the instant from which on the quantity must stay (a push has ended by
/// then); elsewhere the instant that is looked at; 0 is the beginning or the end.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

struct CheckResult {
  std::string kind;        // as in the scene
  std::string subject;     // the body, or "all"
  double value;            // what was reached: an error, a drift, a smallest gap; infinite where what was asked never happened
  double threshold;        // what was allowed
  std::string unit;
  bool passed;
  std::string why;         // the threshold's reason
  bool at_least = false;   // right when value >= threshold instead of <=
  std::string detail;      // where and when the worst was found
};

/// One result a check, in the scene's order. @throws UserError for a kind of check that is not known.
std::vector<CheckResult> judge_run(const scene::Scene& scene, const Trajectory& run);

}  // namespace tumble::engines
