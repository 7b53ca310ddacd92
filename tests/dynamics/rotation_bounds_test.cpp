// Bounds on how fast a body can turn: never below what it does, and not far above.
#include "framework/dynamics/rotation_bounds.h"

#include <gtest/gtest.h>

#include "framework/dynamics/free_rotation.h"
#include "framework/dynamics/world.h"
#include "tests/dynamics/tops.h"

namespace tumble::testing {
namespace {

struct Fastest {
  double speed = 0, acceleration = 0;
};

/// Of the exact motion, seen at `looks` times up to `duration`.
Fastest fastest(const Vector3d& moments, const Spin& start, double duration, int looks) {
  const FreeRotation rotation(moments.asDiagonal());
  Fastest seen;
  Spin spin = start;
  for (int i = 0; i < looks; ++i) {
    const Vector3d& w = spin.omega_body;
    // the same length in either frame
    const Vector3d rate = moments.cwiseProduct(w).cross(w).cwiseQuotient(moments);
    seen = {std::max(seen.speed, w.norm()), std::max(seen.acceleration, rate.norm())};
    spin = rotation.after(spin, duration / looks);
  }
  return seen;
}

RigidBodyState state_of(const Vector3d& moments, const Spin& spin) {
  return {Vector3d::Zero(), spin.world_from_body, Vector3d::Zero(),
          spin.world_from_body * moments.cwiseProduct(spin.omega_body)};
}

TEST(RotationBounds, HoldForTheWholeFreeMotionAndAreReached) {
  Random random(21);
  for (int i = 0; i < 40; ++i) {
    const Vector3d moments = random_moments(random);
    const Spin start{random_rotation(random), random_vector(random, 3)};
    const RotationBounds bounds = bound_rotation(
        state_of(moments, start), finite_inertia(1.0, moments.asDiagonal()), {.duration = 1.0});
    const double period = FreeRotation(moments.asDiagonal()).tumbling(start.omega_body).period;
    const Fastest seen = fastest(moments, start, period, 400);
    EXPECT_GE(bounds.angular_speed, seen.speed) << "top " << i;
    EXPECT_GE(bounds.angular_acceleration, seen.acceleration) << "top " << i;
    // The polhode visits both ends of the segment that the bound is taken from; 400 looks miss them
    // by (pi / 400)^2 at most.
    EXPECT_LE(bounds.angular_speed, 1.001 * seen.speed) << "top " << i;
  }
}

TEST(RotationBounds, HoldForSymmetricAndSphericalTops) {
  Random random(22);
  for (const Vector3d& moments :
       {Vector3d(1, 1, 2), Vector3d(2, 2, 0.1), Vector3d(1, 1e-6, 1), Vector3d(3, 3, 3)}) {
    for (int i = 0; i < 10; ++i) {
      const Spin start{random_rotation(random), random_vector(random, 3)};
      const RotationBounds bounds = bound_rotation(
          state_of(moments, start), finite_inertia(1.0, moments.asDiagonal()), {.duration = 1.0});
      const Fastest seen = fastest(moments, start, 10.0, 200);
      EXPECT_GE(bounds.angular_speed, seen.speed) << moments.transpose();
      // What is seen of a ball's acceleration, 0, is the rounding of w x w: a few eps of |w|^2.
      EXPECT_GE(bounds.angular_acceleration + 4 * kEps * seen.speed * seen.speed, seen.acceleration)
          << moments.transpose();
    }
  }
}

TEST(RotationBounds, LeaveRoomForATorque) {
  // A ball of inertia 0.5 at rest under 2 N m for 3 s ends at 12 rad/s.
  const RigidBodyState resting{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                               Vector3d::Zero()};
  const RotationBounds bounds = bound_rotation(
      resting, finite_inertia(1.0, 0.5 * Matrix3d::Identity()), {.duration = 3.0, .torque = 2.0});
  EXPECT_GE(bounds.angular_speed, 12.0);
  EXPECT_LE(bounds.angular_speed, 12.1);
  EXPECT_GE(bounds.angular_acceleration, 4.0);
}

TEST(RotationBounds, HoldForABodyThatIsTurnedWronglyAndTwisted) {
  Random random(23);
  for (int i = 0; i < 60; ++i) {
    const Vector3d moments = random_moments(random);
    const Spin start{random_rotation(random), random_vector(random, 3)};
    const Inertia inertia = finite_inertia(1.0, moments.asDiagonal());
    const double error = std::pow(10.0, random.between(-4, 0)),
                 torque = i % 2 == 0 ? 0.0 : random.between(0, 5);
    RigidBodyState state = state_of(moments, start);
    const RotationBounds bounds = bound_rotation(
        state, inertia, {.duration = 1.0, .torque = torque, .angular_velocity_error = error});
    // What is wrong points along what it can spoil most: the energy, up or down, for two parts of
    // the second.
    constexpr int kSteps = 2000;
    const double dt = 1.0 / kSteps;
    Vector3d before = omega_of(state, inertia);
    for (int k = 0; k < kSteps; ++k) {
      const double side = k < kSteps / 2 ? 1.0 : (i % 4 < 2 ? 1.0 : -1.0);
      const Vector3d omega_world = omega_of(state, inertia),
                     wrong_world = side * error *
                                   omega_world.cross(state.angular_momentum_world).normalized();
      const Vector3d turn_world = (omega_world + wrong_world) * dt;
      state.world_from_body =
          (Quaterniond(Eigen::AngleAxisd(turn_world.norm(), turn_world.normalized())) *
           state.world_from_body)
              .normalized();
      state.angular_momentum_world += side * torque * dt * omega_world.normalized();
      const Vector3d after = omega_of(state, inertia);
      // One step of this turning is wrong by (|omega| dt)^2.
      EXPECT_LE(after.norm(), bounds.angular_speed * (1 + 1e-4)) << "top " << i << ", step " << k;
      EXPECT_LE((after - before).norm() / dt, bounds.angular_acceleration * (1 + 1e-2))
          << "top " << i << ", step " << k;
      before = after;
    }
  }
}

TEST(RotationBounds, OfARodThatTumblesStayNearItsSpeed) {
  // The little spin about its length that rounding leaves must not be taken for L / I_min.
  for (const double thin : {1e-2, 1e-6, 1e-9}) {
    const Vector3d moments(thin, 1, 1);
    const RotationBounds bounds = bound_rotation(
        state_of(moments,
                 {Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())), {0, 2, 1}}),
        finite_inertia(1.0, moments.asDiagonal()), {.duration = 1.0});
    EXPECT_LE(bounds.angular_speed, 1.01 * std::sqrt(5.0)) << thin;
  }
}

TEST(RotationBounds, AreZeroAtRest) {
  const RigidBodyState resting{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                               Vector3d::Zero()};
  const RotationBounds bounds =
      bound_rotation(resting, finite_inertia(1.0, Matrix3d::Identity()), {.duration = 1.0});
  EXPECT_EQ(bounds.angular_speed, 0.0);
  EXPECT_EQ(bounds.angular_acceleration, 0.0);
}

}  // namespace
}  // namespace tumble::testing
