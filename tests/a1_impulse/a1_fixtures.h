/// What the tests of a1 share: bodies with easy numbers, and words for a wrong answer that a known slip gives.
#pragma once

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

inline const a1::Module& student() { return modules::under_test<a1::Module>(); }

/// Handout anchor of equation (A1.n).
inline std::string equation(const std::string& n) { return "handouts/a1_impulse.md#eq-a1-" + n; }

// ---- Bodies --------------------------------------------------------------------------------------------------------

/// Turns a third of a full turn about (1, 1, 1): x to y to z to x. Its four numbers are exact, and a matrix made from it
/// differs from its transpose, unlike that of a half or a quarter turn of a diagonal tensor.
inline Quaterniond third_turn() { return {0.5, 0.5, 0.5, 0.5}; }

/// At rest, not turned: 2 kg with principal moments 1, 2, 4 kg m^2.
Body block(const Vector3d& com_world);
/// At rest: a solid ball, moments 2/5 m r^2.
Body ball(double mass, double radius, const Vector3d& com_world);
/// Immovable; its inertia_body is NaN, because nobody may use it.
Body wall(const Vector3d& com_world);

// ---- Judging -------------------------------------------------------------------------------------------------------

/// Angular momentum about the world's origin [kg m^2/s], and kinetic energy [J], of a movable body at some velocity.
Vector3d angular_momentum(const Body& body, const Velocity& velocity);
double kinetic_energy(const Body& body, const Velocity& velocity);
inline Velocity velocity_of(const Body& body) { return {body.velocity_world, body.omega_world}; }
/// How fast the gap grows when the bodies have these velocities [m/s].
double gap_rate(const Contact& contact, const Body& a, const Velocity& velocity_a, const Body& b, const Velocity& velocity_b);

/// A wrong answer, and the slip that gives it.
template <class Value>
using Slips = std::vector<std::pair<Value, std::string>>;

inline const std::string kNotANumber =
    "no number came out: infinite mass (use inverse_mass and inverse_inertia_body, never mass or inertia_body) or a division by 0";

/// The words of the slip whose answer was found; `otherwise` when it is none of them.
inline std::string likely(double found, const Slips<double>& slips, const std::string& otherwise) {
  for (const auto& [gives, words] : slips) {
    if (std::abs(found - gives) <= 1e-9 * (1.0 + std::abs(gives))) return words;
  }
  return std::isfinite(found) ? otherwise : kNotANumber;
}

template <int n>
std::string likely(const Eigen::Matrix<double, n, 1>& found, const Slips<Eigen::Matrix<double, n, 1>>& slips,
                   const std::string& otherwise) {
  for (const auto& [gives, words] : slips) {
    if ((found - gives).norm() <= 1e-9 * (1.0 + gives.norm())) return words;
  }
  return found.allFinite() ? otherwise : kNotANumber;
}

// ---- First something, then nothing -------------------------------------------------------------------------------------
// A miss is an answer only from a function that can hit: a test whose right answer is "nothing" asks first for a case in which
// something must come. What comes is judged elsewhere; here it must only be there, so that a slip is paid for once.
// @return false when nothing came: the test has failed with that story, and should end

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

// ---- Seeded random scenes --------------------------------------------------------------------------------------------

Vector3d random_vector(Random& random, double size);
Vector3d random_direction(Random& random);
Quaterniond random_rotation(Random& random);
/// Anything: mass 0.1 to 10 kg, moments of a real solid (no one exceeds the sum of the others), any pose and motion.
Body random_body(Random& random);

struct Encounter {
  Contact contact;
  Body a, b;
};
/// Two random bodies touching at a random point, approaching. Every fourth time B is a moving wall.
Encounter random_encounter(Random& random, int number);

}  // namespace tumble::testing
