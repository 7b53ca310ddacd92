/// Judges a recorded run by numbers: what the scene's `checks` ask. Reads scene and trajectory,
/// never an engine.
///
/// A check is right when value <= tolerance, unless the line says otherwise.
///   energy              largest |E - E0| relative to the available energy (below) [-]
///   energy_not_rising   largest rise of E above an earlier value, relative to the same [-]
///   momentum            largest |P - P0| [kg m/s]; with `expected`: |P - expected| at `at_s`
///   angular_momentum    the same for L about the world's origin [kg m^2/s]
///   gap                 smallest gap of any frame [m]; right when >= -tolerance
///   final_position      distance of the body's centre from `expected` at `at_s` [m]
///   final_velocity      the same for its velocity [m/s]
///   centre_of_mass      distance of the common centre of mass of `bodies`, or of all movable
///                       bodies, from `expected` at `at_s` [m]
///   impact_times        largest error of the first impacts of `body` and `other` [s]
///   event_count         |collisions - expected|, of `body` and `other` where named [-]
///   restitution_law     largest |v_after + e v_before| / |v_before| of all collisions [-]
///   side_of_wall        smallest distance of body from other's centre along `axis` (world), on its
///                       first side [m]; right when >= -tolerance
///   flips               |flips - expected|: reversals of the body's own `axis` [-]
///   rod_length          largest |length - L0| of `link`, or of any rod, from positions alone [m]
///   joint_gap           largest distance of the two points that `link`, or any joint, joins [m]
///   joint_angle         largest angle of the axes of a hinge, or of the bodies of a weld [rad]
///   link_force          |force in `link` - expected| / |expected| at `at_s` [-], in N where
///                       expected is 0; tension is > 0
///   reaction            the same for the force of persistent contacts on `body`, from `other`
///                       where named, along `axis` (world)
///   drift               largest distance from the position at `at_s`, of `body`, `bodies`, or any
///                       body [m]
///   tilt                largest rotation from the orientation at `at_s`, of the same [rad]
///   at_rest             largest kinetic energy per kilogram, of the same, from `at_s` on; 0: at
///                       the end [J/kg]
///   distance_travelled  |displacement of the body from its start - expected| at `at_s`, along
///                       `axis` (world) where given [m]
///   angle_at            |angle - expected| at `at_s`: rotation of the body about `axis` (world)
///                       with whole turns, which rates at frames tell between them [rad]
///   stands              largest angle between the own `axis` of `body` or `bodies` and its first
///                       direction, at `at_s` [rad]
///   falls               the same; the smallest [rad]; right when >= tolerance
///   order_of_falls      number of `bodies` that lean by expected [rad] before the one before them,
///                       or never [-]
///
/// The faults that the run's watch found (engines/base/run_watch.h) follow, as failed checks
/// whatever the scene asks:
///   link_open           largest opening of a rod or joint over its size [-], or angle [rad]
///   projection_open     errors that a projection of rods and joints left, over the island's size
///                       [-]
///   contact_unsolved    approach and slip that the impulses of contacts left, over the island's
///                       speed [-]
///   turn_unresolved     rotation of a body in a step of a method that samples [rad]
///   turns_wrong         angle by which steps have turned a body wrong that nothing turns, all its
///                       flights together [rad]
///   overlap_left        overlap that the corrections of places left, over the radius of the
///                       smaller body [-]
///   energy_rises        rise of E above its least value so far, without the work of point forces
///                       and motors, relative to the available energy [-]
///   energy_lost         what bodies that springs, rods and joints link have lost beside what drag,
///                       dampers, water, forces and motors take, away from impacts and persistent
///                       contacts, relative to the most that moved, was stored or came down [-]
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
  std::string kind;     // as in the scene
  std::string subject;  // the body, or "all"
  // the value: an error, a drift, a smallest gap; infinite where the event never happened
  double value;
  double threshold;  // the tolerance
  std::string unit;
  bool passed;
  std::string why;        // the reason of the threshold
  bool at_least = false;  // passes when value >= threshold instead of <=
  std::string detail;     // place and time of the worst value
};

/// Whether a check's value is how far the run was from what the scene expects, and not the quantity
/// itself: 0 flips off, where three are expected and found.
bool is_off_by(const CheckResult& check);

/// A check's unit is a label for people: a number in another unit would be compared as if it were
/// in metres.
/// @throws UserError at the first check with a unit that is not its kind's
void refuse_other_units(const scene::Scene& scene);

/// One result per check, in the scene's order, then one for each of the run's faults, and one where
/// an impact changed the energy by more than any law allows. @throws UserError for an unknown kind
/// of check.
std::vector<CheckResult> judge_run(const scene::Scene& scene, const Trajectory& run);

/// The instants at which checks look: a run that is to be judged records frames there
/// (RunOptions::instants_s). [s]
std::vector<double> instants_of_checks(const scene::Scene& scene);

}  // namespace tumble::engines
