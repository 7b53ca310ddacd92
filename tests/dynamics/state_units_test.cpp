// A tolerance asks for the same accuracy of the same motion in any units of length and mass.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/dynamics/methods.h"
#include "framework/dynamics/state_units.h"

namespace tumble::testing::state_units_test {
namespace {

/// A box that tumbles on a spring from a fixed point to one of its corners. All lengths in
/// `length`, all masses in `mass`; times are the same.
struct Box {
  double length = 1.0, mass = 1.0;
  Inertia inertia =
      finite_inertia(mass, mass* length* length* Vector3d(0.7, 1.1, 1.5).asDiagonal());
  Vector3d corner_body = length * Vector3d(0.5, 0.3, 0.2);

  RigidBodyState start() const {
    return {length * Vector3d(0.4, -0.3, 1.0), Quaterniond::Identity(),
            mass * length * Vector3d(0.5, 0.2, -0.4),
            mass * length * length * Vector3d(1.0, -2.0, 3.0)};
  }
  VectorXd rate(const VectorXd& y) const {
    RigidBodyState state = unpack(y);
    state.world_from_body.normalize();
    const Quaterniond& q = state.world_from_body;
    const Vector3d arm = q * corner_body, spring = state.com_world + arm;
    const double stiffness = 25.0 * mass, rest = 0.6 * length;
    const Vector3d force = -stiffness * (1.0 - rest / spring.norm()) * spring;
    const Vector3d omega =
        q * (inertia.inverse_inertia_body * (q.conjugate() * state.angular_momentum_world));
    const Quaterniond turning = Quaterniond(0.0, omega.x(), omega.y(), omega.z()) * q;
    VectorXd slope(kStateSize);
    slope << inertia.inverse_mass * state.momentum_world, 0.5 * turning.w(), 0.5 * turning.x(),
        0.5 * turning.y(), 0.5 * turning.z(), force, arm.cross(force);
    return slope;
  }
};

struct Found {
  RigidBodyState end;
  int evaluations = 0;
};

/// After 2 s: of a controlled method in one step, of others in 32.
Found run(const Box& box, const Method& method, double tolerance) {
  Laws laws;
  laws.integrate_step = step_of(method, tolerance);
  laws.steps_in_units = needs_units(method);
  const VectorXd units = units_of_state(box.inertia, radius_of_gyration(box.inertia));
  const int steps = method.controlled ? 1 : 32;
  const double h = 2.0 / steps;
  Found found;
  const OdeFunction f = [&](double, const VectorXd& y) {
    ++found.evaluations;
    return box.rate(y);
  };
  VectorXd y = pack(box.start());
  for (int k = 0; k < steps; ++k) y = integrate_by(laws, f, k * h, y, h, units);
  found.end = unpack(y);
  return found;
}

double farthest(const Found& found, const Box& box, const Found& expected) {
  return std::max(
      (found.end.com_world / box.length - expected.end.com_world).norm(),
      (found.end.world_from_body.coeffs() - expected.end.world_from_body.coeffs()).norm());
}

TEST(StateUnits, OfABodyOfAKilogramAndAMetreAreThoseOfSi) {
  const Inertia inertia = finite_inertia(1.0, Matrix3d::Identity());
  EXPECT_EQ(radius_of_gyration(inertia), 1.0);
  EXPECT_EQ(units_of_state(inertia, 1.0), VectorXd::Ones(kStateSize));
}

TEST(StateUnits, AreNotNeededByLawsThatDoNotAskForThem) {
  const OdeFunction growth = [](double, const VectorXd& y) -> VectorXd { return y; };
  Laws laws;
  laws.integrate_step = step_of(method_named("rk4"), 0.0);
  const VectorXd y = VectorXd::Constant(3, 2.0);
  EXPECT_EQ(integrate_by(laws, growth, 0.0, y, 0.5, VectorXd()),
            laws.integrate_step(growth, 0.0, y, 0.5));
}

TEST(StateUnits, ArePowersOfTwoNearestInRatio) {
  for (const auto& [value, nearest] : {std::pair{1.0, 1.0},
                                       {1.4, 1.0},
                                       {1.5, 2.0},
                                       {0.7, 0.5},
                                       {0.75, 1.0},
                                       {1e-3, std::ldexp(1.0, -10)}})
    EXPECT_EQ(nearest_power_of_two(value), nearest) << value;
}

TEST(StateUnits, OfABodyWithoutSizeAreThoseOfWhatItIsLinkedIn) {
  const VectorXd units = units_of_state(finite_inertia(4.0, 1e-12 * Matrix3d::Identity()), 2.0);
  EXPECT_EQ(units[0], 2.0);
  EXPECT_EQ(units[7], 8.0);
}

// Units of length and mass that are powers of two scale every number of a run exactly: the same
// steps, and the same end to the last bit. With one tolerance for numbers in SI units the small
// box's momenta, of 1e-12 kg m/s, would be followed by no method.
TEST(StateUnits, LeaveTheSameRunInUnitsOfPowersOfTwo) {
  for (const Method& method : methods()) {
    const Found expected = run({}, method, 1e-7);
    for (const int exponent : {-10, 10}) {
      const Box box{std::ldexp(1.0, exponent), std::ldexp(1.0, 3 * exponent)};
      const Found found = run(box, method, 1e-7);
      EXPECT_EQ(found.evaluations, expected.evaluations) << method.name << ", 2^" << exponent;
      EXPECT_EQ(farthest(found, box, expected), 0.0) << method.name << ", 2^" << exponent;
    }
  }
}

// Millimetres and milligrams, kilometres and gigatons: units are rounded, so the steps are not the
// same; their number, and the accuracy are.
TEST(StateUnits, LeaveNumberOfStepsAndAccuracyInAnyUnits) {
  constexpr double kTolerance = 1e-7;
  const Found truth = run({}, method_named("fehlberg78"), 1e-12);
  for (const Method& method : methods()) {
    if (!method.controlled) continue;
    const Found metres = run({}, method, kTolerance);
    for (const double length : {1e-3, 1e3}) {
      const Box box{length, length * length * length};
      const Found found = run(box, method, kTolerance);
      EXPECT_LT(found.evaluations, 2 * metres.evaluations) << method.name << ", " << length;
      EXPECT_GT(2 * found.evaluations, metres.evaluations) << method.name << ", " << length;
      // some hundred parts that may each err by it, and what the motion makes of their errors
      EXPECT_LT(farthest(found, box, truth), 1e5 * kTolerance) << method.name << ", " << length;
    }
  }
}

}  // namespace
}  // namespace tumble::testing::state_units_test
