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
/// | centre_of_mass   | distance of the common centre of mass of `bodies`, or of all that move, from `expected` at `at_s` [m] | <= tolerance |
/// | impact_times     | largest error of the first impacts of `body` and `other` [s]          | <= tolerance               |
/// | event_count      | |collisions - expected|, of `body` and `other` where named [-]        | <= tolerance               |
/// | restitution_law  | largest |v_after + e v_before| over |v_before|, of all collisions [-] | <= tolerance               |
/// | side_of_wall     | smallest distance of body from other's centre along `axis` (world), on the side where it began [m] | >= -tolerance |
/// | flips            | |flips - expected|: how often the body's own `axis` turned over against where it pointed first [-]  | <= tolerance |
/// | rod_length       | largest |length - L0| of `link`, or of any rod, from places alone [m]  | <= tolerance               |
/// | joint_gap        | largest distance of the two points that `link`, or any joint, holds together [m] | <= tolerance     |
/// | joint_angle      | largest angle of the two axes of a hinge, or of the two bodies of a weld [rad]   | <= tolerance     |
/// | link_force       | |force in `link` - expected| over |expected| at `at_s` [-], N where it is 0; what pulls together is > 0 | <= tolerance |
/// | reaction         | the same for the force of lasting contacts on `body`, from `other` where named, along `axis` (world)   | <= tolerance |
/// | drift            | largest distance from where it was at `at_s`, of `body`, `bodies`, or any [m]    | <= tolerance     |
/// | tilt             | largest turn against its orientation at `at_s`, of the same [rad]                | <= tolerance     |
/// | at_rest          | largest kinetic energy a kilogram, of the same, from `at_s` on; 0: at the end [J/kg] | <= tolerance |
/// | distance_travelled | |way of body from its start - expected| at `at_s`, along `axis` (world) where given [m] | <= tolerance |
/// | angle_at         | |angle - expected| at `at_s`: how far body turned about `axis` (world), whole turns included [rad]; it must
///                      turn less than half way round between two frames                               | <= tolerance |
/// | stands           | how far the own `axis` of `body` or `bodies` leans from where it pointed first, at `at_s`; the largest [rad] | <= tolerance |
/// | falls            | the same; the smallest [rad]                                          | >= tolerance               |
/// | order_of_falls   | how many of `bodies` lean by expected [rad] before the one before them, or never [-] | <= tolerance |
///
/// The faults that the run's watch found (engines/base/run_watch.h) follow, as failed checks
/// whatever the scene asks:
/// | link_open        | how far a rod or joint came apart, over its size [-], or at an angle [rad] | never                 |
/// | projection_open  | what a correction onto rods and joints left of their errors, over the group's size [-] | never     |
/// | contact_unsolved | what impulses of contacts left of approach and slip, over the group's speed [-]        | never     |
/// | turn_unresolved  | how far a body turned in a step of a method that samples [rad]            | never                 |
/// | energy_rises     | rise of E above its least value so far, without what point forces and motors bring in, over what there was to begin with [-] | never |
///
/// In addition, for every scene: `impact_energy`, the change of kinetic energy in an impact
/// relative to what restitution and friction give (`Event::energy_excess`), over the kinetic energy
/// before it; in the frame of driven bodies. It is reported only where it is wrong.
///
/// Energies are compared with the kinetic energy at `at_s` plus the deepest fall of the potential
/// energy below its value there: energy that a run creates is not in this scale, so it cannot widen
/// its own tolerance.
/// Rounding is not held against a run: for an energy eps of its terms, times the root of the number
/// of steps; for a gap a few eps of sizes and positions.
/// For energy, momentum, angular momentum, drift and tilt `at_s` is the time from which on the
/// quantity must stay constant (a push has ended by then); elsewhere the time of the value; 0 is
/// the beginning or the end.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

struct CheckResult {
  std::string kind;        // as in the scene
  std::string subject;     // the body, or "all"
  double value;            // the value: an error, a drift, a smallest gap; infinite where the event never happened
  double threshold;        // the tolerance
  std::string unit;
  bool passed;
  std::string why;         // the reason of the threshold
  bool at_least = false;   // passes when value >= threshold instead of <=
  std::string detail;      // place and time of the worst value
};

/// A check's unit is a label for people: a number in another unit would be compared as if it were
/// in metres.
/// @throws UserError at the first check with a unit that is not its kind's
void refuse_other_units(const scene::Scene& scene);

/// One result per check, in the scene's order, then one for each of the run's faults, and one where
/// an impact changed the energy by more than any law allows. @throws UserError for an unknown kind
/// of check.
std::vector<CheckResult> judge_run(const scene::Scene& scene, const Trajectory& run);

}  // namespace tumble::engines
