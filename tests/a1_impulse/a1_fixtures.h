/// Shared by the tests of a1: bodies with simple numbers, and names of known mistakes for wrong
/// answers.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assignments/a1_impulse/a1_impulse.h"
#include "framework/core/random.h"
#include "framework/modules/under_test.h"
#include "tests/support/story.h"

namespace tumble::testing {

// times the largest number involved: at most 40 roundings of eps / 2 each
inline constexpr double kRoundoff = 20 * kEps;
inline const Vector3d kUp = Vector3d::UnitZ();

inline const a1::Module& student() { return modules::under_test<a1::Module>(); }

/// Handout anchor of equation (A1.n).
inline std::string equation(const std::string& n) { return "handouts/a1_impulse.md#eq-a1-" + n; }

// ---- Bodies ------------------------------------------------------------------------------------

/// A third of a full turn about (1, 1, 1): x to y to z to x. Its four numbers are exact, and its
/// matrix differs from its transpose, unlike a half or a quarter turn with a diagonal tensor.
inline Quaterniond third_turn() { return {0.5, 0.5, 0.5, 0.5}; }

/// At rest, not rotated: 2 kg with principal moments 1, 2, 4 kg m^2.
Body block(const Vector3d& com_world);
/// At rest, not rotated: 2 kg, with no axis of its body frame a principal one, so that a formula
/// for principal axes fails.
///   I = (4, -2, -2; -2, 5, -1; -2, -1, 6) kg m^2,   I^-1 = (29, 14, 12; 14, 20, 8; 12, 8, 16) / 64
Body bracket(const Vector3d& com_world);
/// At rest: a solid ball, moments 2/5 m r^2.
Body ball(double mass, double radius, const Vector3d& com_world);
/// Immovable; its inertia_body is NaN, because it must not be used.
Body wall(const Vector3d& com_world);

// ---- Judging -----------------------------------------------------------------------------------

/// Angular momentum about the world's origin [kg m^2/s], and kinetic energy [J], of a movable body
/// at some velocity.
Vector3d angular_momentum(const Body& body, const Velocity& velocity);
double kinetic_energy(const Body& body, const Velocity& velocity);
inline Velocity velocity_of(const Body& body) { return {body.velocity_world, body.omega_world}; }
/// Rate of the gap for these velocities [m/s].
double gap_rate(const Contact& contact, const Body& a, const Velocity& velocity_a, const Body& b,
                const Velocity& velocity_b);

/// A wrong answer, and the mistake that gives it.
template <class Value>
using Slips = std::vector<std::pair<Value, std::string>>;

inline const std::string kNotANumber =
    "no number came out: infinite mass (use inverse_mass and inverse_inertia_body, never mass or "
    "inertia_body) or a division by 0";

inline constexpr double kSameAnswer = 1e-9;  // relative: far above rounding, far below any mistake

/// The name of the mistake whose answer was found, as one that the answer shows; `otherwise`, which
/// is only something to look at, for none.
inline Mistake likely(double found, const Slips<double>& slips, const Mistake& otherwise) {
  for (const auto& [gives, words] : slips) {
    if (std::abs(found - gives) <= kSameAnswer * std::max(std::abs(found), std::abs(gives)))
      return shown(words);
  }
  return std::isfinite(found) ? otherwise : kNotANumber;
}

template <int n>
Mistake likely(const Eigen::Matrix<double, n, 1>& found,
               const Slips<Eigen::Matrix<double, n, 1>>& slips, const Mistake& otherwise) {
  for (const auto& [gives, words] : slips) {
    if ((found - gives).norm() <= kSameAnswer * std::max(found.norm(), gives.norm()))
      return shown(words);
  }
  return found.allFinite() ? otherwise : kNotANumber;
}

// ---- First an answer, then none --------------------------------------------------------------
// A test whose right answer is "nothing" first calls the function for a case with an answer,
// because a function that never answers would pass. That answer is judged elsewhere; here it must
// only exist, so that a mistake costs points once.
// @return false without an answer: the test has failed with that story, and should end

bool gives_hits();
bool gives_linear_acceleration();
bool gives_angular_acceleration();
bool gives_relative_velocities();
bool tells_motions_apart();
bool gives_impulses();
bool gives_impulses_without_rotation();
/// apply_impulse moves a movable body; resolve_collision moves bodies that approach.
bool moves_a_struck_body();
bool moves_colliding_bodies();

// ---- Seeded random scenes ----------------------------------------------------------------------

Vector3d random_vector(Random& random, double size);
Vector3d random_direction(Random& random);
Quaterniond random_rotation(Random& random);
/// Any: mass 0.1 to 10 kg, moments of a real solid (none exceeds the sum of the others), any pose
/// and motion.
Body random_body(Random& random);

struct Encounter {
  Contact contact;
  Body a, b;
};
/// Two random bodies in contact at a random point, approaching. Every fourth time B is a moving
/// wall.
Encounter random_encounter(Random& random, int number);

/// Two asymmetric bodies in skew poses that collide along a skew normal, both rotating: no number
/// is 0, 1, equal to another, or along an axis, so that every term of (A1.5) and (A1.9)
/// contributes.
Encounter skew_encounter();
/// The same with units of length, mass and time changed: every power of two shifts exponents only,
/// so that answers scale exactly.
Encounter scaled(const Encounter& e, double length, double mass, double time);
Body scaled(const Body& body, double length, double mass, double time);
/// Changes of unit that a threshold of a millionth in any quantity would notice: lengths, masses,
/// times, up and down.
struct Units {
  double length, mass, time;
};
std::vector<Units> changes_of_unit();
std::string show(const Units& units);
/// The slip where an answer is wrong in other units: shown, where the same question in plain units
/// is answered rightly. Where that is wrong too, no threshold is to blame.
Mistake slip_of_units(bool right_in_plain_units, const std::string& slip);

// ---- (A1.5) and (A1.9) with a slip in them -----------------------------------------------------

enum class InertiaSlip { kNone, kBodyAxes, kTransposed, kDiagonal, kOneByOne, kNotInverted };

/// The formulas term by term. Each default is right; a slip is one of them changed.
struct FormulaSlip {
  bool spin_of_a = true, spin_of_b = true;        // w x r in the relative velocity
  bool turning_of_a = true, turning_of_b = true;  // in the denominator
  bool own_arms = true;                           // false: r_a serves B as well
  bool arms_from_com = true;                      // false: from the world's origin
  bool walls_move = true;                         // false: what is immovable is at rest
  bool right_handed = true;                       // false: r x w for w x r
  InertiaSlip inertia_of_a = InertiaSlip::kNone, inertia_of_b = InertiaSlip::kNone;
};

double relative_normal_velocity_by(const Encounter& e, const FormulaSlip& slip = {});
double collision_impulse_by(const Encounter& e, double restitution, const FormulaSlip& slip = {});
Matrix3d inverse_inertia_by(const Body& body, InertiaSlip slip = InertiaSlip::kNone);

/// What known slips would give for this encounter, with their words; slips that change nothing here
/// are left out.
Slips<double> slips_of_relative_velocity(const Encounter& e);
Slips<double> slips_of_impulse(const Encounter& e, double restitution);
/// The same for the angular velocity that an impulse gives, and for w' of (A1.4).
Slips<Vector3d> slips_of_apply(const Body& body, const Vector3d& impulse_world,
                               const Vector3d& point_world);
Slips<Vector3d> slips_of_angular_acceleration(const Body& body, const Vector3d& torque_world);
/// w' by (A1.4), in world axes throughout: another way than the header's.
Vector3d angular_acceleration_by(const Body& body, const Vector3d& torque_world);

}  // namespace tumble::testing
