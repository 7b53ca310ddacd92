// The laws that a scene runs on before a student has written any: integration and time of impact
// from a library.
#include "framework/dynamics/laws.h"

#include <gtest/gtest.h>

#include "framework/dynamics/free_rotation.h"
#include "framework/dynamics/world.h"
#include "tests/dynamics/tops.h"

namespace tumble::testing {
namespace {

const Laws& laws() {
  static const Laws library = library_laws();
  return library;
}

const Wrench kNoWrench{Vector3d::Zero(), Vector3d::Zero()};

RigidBodyState integrate(RigidBodyState state, const Inertia& inertia, double duration, int steps) {
  const OdeFunction f = [&](double, const VectorXd& y) {
    return laws().state_derivative(unpack(y), inertia, kNoWrench);
  };
  for (int i = 0; i < steps; ++i) {
    state = unpack(laws().integrate_step(f, i * duration / steps, pack(state), duration / steps));
    state.world_from_body = laws().renormalize(state.world_from_body);
  }
  return state;
}

RigidBodyState spinning_block() {
  return {{1, 2, 3}, Quaterniond(0.5, 0.5, 0.5, 0.5), {4, -2, 1}, {0.3, 2.0, -0.4}};
}

TEST(LibraryLaws, TurnAFreeBodyWithOrderFour) {
  const Inertia inertia = finite_inertia(2.0, Vector3d(1, 2, 3).asDiagonal());
  const Quaterniond exact = advance_freely(spinning_block(), inertia, 4.0).world_from_body;
  double coarser = kUnset;
  for (const int steps : {100, 200, 400, 800}) {
    const double error =
        difference(integrate(spinning_block(), inertia, 4.0, steps).world_from_body, exact);
    // The order itself is off by O(h): 0.1 is four times what is left of that here.
    if (steps > 100) {
      EXPECT_NEAR(std::log2(coarser / error), 4.0, 0.1) << steps << " steps";
    }
    coarser = error;
  }
}

TEST(LibraryLaws, KeepMomentaExactlyAndEnergyToOrderFour) {
  const Inertia inertia = finite_inertia(2.0, Vector3d(1, 2, 3).asDiagonal());
  const double energy = kinetic_energy(spinning_block(), inertia);
  for (const int steps : {100, 200, 400}) {
    const RigidBodyState later = integrate(spinning_block(), inertia, 4.0, steps);
    EXPECT_EQ(later.momentum_world, spinning_block().momentum_world);
    EXPECT_EQ(later.angular_momentum_world, spinning_block().angular_momentum_world);
    // |w| = 1.05 rad/s: (w h)^4 of the energy is a few times what an orientation off by (w h)^5 t /
    // (120 h) changes it by.
    EXPECT_NEAR(kinetic_energy(later, inertia), energy, std::pow(1.05 * 4.0 / steps, 4) * energy)
        << steps << " steps";
  }
}

TEST(LibraryLaws, FallInAParabolaWithoutTruncationError) {
  const Inertia inertia = finite_inertia(2.0, Matrix3d::Identity());
  const OdeFunction f = [&](double, const VectorXd& y) {
    return laws().state_derivative(unpack(y), inertia,
                                   {Vector3d(0, 0, -2.0 * 9.81), Vector3d::Zero()});
  };
  const RigidBodyState start{{0, 0, 5}, Quaterniond::Identity(), {2, 0, 4}, Vector3d::Zero()};
  const RigidBodyState later = unpack(laws().integrate_step(f, 0, pack(start), 0.5));
  EXPECT_NEAR(later.com_world.x(), 0.5, 4 * kEps);
  EXPECT_NEAR(later.com_world.z(), 5 + 2 * 0.5 - 0.5 * 9.81 * 0.25, 10 * kEps * 6);
}

TEST(LibraryLaws, LeaveABodyOfInfiniteMassWhereItIs) {
  const VectorXd rate = laws().state_derivative(
      {{1, 2, 3}, Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()}, infinite_inertia(),
      kNoWrench);
  EXPECT_EQ(rate, VectorXd(VectorXd::Zero(kStateSize)));
}

TEST(LibraryLaws, StopAnImpactOnTheOpenSideAndCountEveryLook) {
  for (const double tolerance : {1e-3, 1e-9, 1e-12}) {
    int looks = 0;
    const auto gap = [&looks](double t) {
      ++looks;
      return 4.5 + 2 * t - 4.905 * t * t;
    };
    const RootResult found = laws().find_impact_time(
        gap, [](double) { return 0.0; }, 0.0, 3.0, tolerance);
    EXPECT_EQ(found.status, RootStatus::kConverged);
    EXPECT_EQ(found.evaluations, looks);
    EXPECT_LE(found.time, 1.18315682439326991 + 1e-15);
    EXPECT_GE(found.time, 1.18315682439326991 - tolerance - 1e-15);
    EXPECT_GE(found.residual, 0.0);
    EXPECT_EQ(found.residual, gap(found.time));
  }
}

TEST(LibraryLaws, SaySoWhenNoImpactIsSeen) {
  const RootResult found = laws().find_impact_time([](double t) { return 1 + t * t; },
                                                   [](double t) { return 2 * t; }, -1.0, 1.0, 1e-9);
  EXPECT_EQ(found.status, RootStatus::kNoSignChange);
  EXPECT_TRUE(std::isnan(found.time));
}

TEST(LibraryLaws, RefuseAGapThatOpensInsteadOfClosing) {
  // -1 to +1: bodies that overlap and part. The end of that is no impact.
  for (const double high : {1.0, 2.0}) {
    const RootResult found = laws().find_impact_time([](double t) { return t - 1; },
                                                     [](double) { return 1.0; }, 0.0, high, 1e-9);
    EXPECT_EQ(found.status, RootStatus::kNoSignChange) << high;
    EXPECT_TRUE(std::isnan(found.time)) << high;
    EXPECT_EQ(found.evaluations, 2) << high;
  }
}

TEST(LibraryLaws, FindNothingInAGapThatIsNotANumber) {
  const RootResult found = laws().find_impact_time([](double) { return kUnset; },
                                                   [](double) { return 0.0; }, 0.0, 1.0, 1e-9);
  EXPECT_EQ(found.status, RootStatus::kNotConverged);
}

}  // namespace
}  // namespace tumble::testing
