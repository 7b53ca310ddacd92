/// What the tests of a3 share: bodies, scenes with known forces, the laws that every right answer
/// obeys, and words for the slip behind a wrong one.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assignments/a3_constraints/a3_constraints.h"
#include "framework/core/random.h"
#include "framework/modules/under_test.h"
#include "tests/support/story.h"

namespace tumble::a3_testing {

// relative to the largest term: fewer than 20 roundings
inline constexpr double kRoundoff = 20 * testing::kEps;

using namespace tumble::testing;

inline constexpr double kGravity = 9.81;  // m/s^2

/// The module under test, whichever of its three bodies is behind it.
inline const a3::Module& a3_module() { return modules::under_test<a3::Module>(); }

/// Handout anchor of equation (A3.n).
inline std::string equation(int n) {
  return "handouts/a3_constraints.md#eq-a3-" + std::to_string(n);
}

// ---- Words for a slip --------------------------------------------------------------------------

/// A wrong answer, and the slip that gives it.
template <class Value>
using Slips = std::vector<std::pair<Value, std::string>>;

inline double distance(double a, double b) { return std::abs(a - b); }
template <class A, class B>
double distance(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() ? (a - b).norm() : INFINITY;
}

/// The words of the slip whose answer was found, to 1e-9 of its size, as one that the answer shows;
/// `otherwise`, which is only something to look at, when it is none of them.
template <class Found, class Value = Found>
Mistake likely(const Found& found, const Slips<Value>& slips, const Mistake& otherwise) {
  for (const auto& [gives, words] : slips)
    if (distance(found, gives) <= 1e-9 * (1 + distance(gives, Value(0 * gives))))
      return shown(words);
  return otherwise;
}

inline VectorXd vector(std::initializer_list<double> numbers) {
  return Eigen::Map<const VectorXd>(numbers.begin(), static_cast<Eigen::Index>(numbers.size()));
}

// ---- Bodies ------------------------------------------------------------------------------------

/// Turns a third of a full turn about (1, 1, 1): x to y to z to x. Its numbers are exact, and so
/// are those of its matrix.
inline Quaterniond third_turn() { return {0.5, 0.5, 0.5, 0.5}; }
/// 2 kg, at com_world, not turned, at rest.
Body resting_at(const Vector3d& com_world);

Vector3d random_vector(Random& random, double size);
Quaterniond random_rotation(Random& random);
/// Anywhere within 2 m of the origin, in any pose, moving and turning.
Body random_body(Random& random);

/// (v, omega) of a body, world frame.
Vector6d velocity_of(const Body& body);

// ---- Systems of bodies and rows ----------------------------------------------------------------

/// Bodies with the rows between them, as the two solving functions get them.
struct Rig {
  std::string scene;
  std::vector<ConstrainedBody> bodies;
  std::vector<Constraint> rows;
  VectorXd wanted;  // (m) [m/s^2]

  Eigen::Index size() const { return static_cast<Eigen::Index>(rows.size()); }
  VectorXd multipliers() const { return a3_module().constraint_multipliers(rows, bodies, wanted); }
};

/// A body as constraints see it, under gravity.
ConstrainedBody movable(double mass, const Matrix3d& inverse_inertia_world);
ConstrainedBody point_mass(double mass);  // a small ball: moments 1e-2 of its mass
ConstrainedBody ceiling();
/// A row that holds two points: n from B to A, arms from the centres of mass.
Constraint rod_between(int a, const Vector3d& arm_a, int b, const Vector3d& arm_b,
                       const Vector3d& n, double velocity_product = 0.0);
/// Masses that hang one below the other from the ceiling, the first rod first; body 0 is the
/// ceiling.
Rig hanging_chain(const std::vector<double>& masses);
/// A tree of bodies with some closed loops, random masses, inertias, arms, accelerations and
/// velocity products; rows independent.
Rig random_rig(Random& random, int bodies, int extra_rows);

/// Sum of J^T lambda for each body, (6n).
VectorXd forces_on_bodies(const Rig& rig, const VectorXd& lambda);
/// C'' of each row when the multipliers act, (m), computed body by body.
VectorXd accelerations_of_rows(const Rig& rig, const VectorXd& lambda);
/// Largest |term| in any row's sum, for the smallest multipliers that fulfil the rows: what
/// round-off is measured by, whatever a submission answers. Cost: O(rows^3)
double size_of_terms(const Rig& rig);
/// J M^-1 J^T, dense.
MatrixXd dense_matrix(const Rig& rig);

}  // namespace tumble::a3_testing
