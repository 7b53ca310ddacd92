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
    const Vector3d rate = moments.cwiseProduct(w).cross(w).cwiseQuotient(moments);  // the same length in either frame
    seen = {std::max(seen.speed, w.norm()), std::max(seen.acceleration, rate.norm())};
    spin = rotation.after(spin, duration / looks);
  }
  return seen;
}

RigidBodyState state_of(const Vector3d& moments, const Spin& spin) {
  return {Vector3d::Zero(), spin.world_from_body, Vector3d::Zero(), spin.world_from_body * moments.cwiseProduct(spin.omega_body)};
}

TEST(RotationBounds, HoldForTheWholeFreeMotionAndAreReached) {
  Random random(21);
  for (int i = 0; i < 40; ++i) {
    const Vector3d moments = random_moments(random);
    const Spin start{random_rotation(random), random_vector(random, 3)};
    const RotationBounds bounds = bound_rotation(state_of(moments, start), finite_inertia(1.0, moments.asDiagonal()), 0.0, 1.0);
    const double period = FreeRotation(moments.asDiagonal()).tumbling(start.omega_body).period;
    const Fastest seen = fastest(moments, start, period, 400);
    EXPECT_GE(bounds.angular_speed, seen.speed) << "top " << i;
    EXPECT_GE(bounds.angular_acceleration, seen.acceleration) << "top " << i;
    // The polhode visits both ends of the segment that the bound is taken from; 400 looks miss them by (pi / 400)^2 at most.
    EXPECT_LE(bounds.angular_speed, 1.001 * seen.speed) << "top " << i;
  }
}

TEST(RotationBounds, HoldForSymmetricAndSphericalTops) {
  Random random(22);
  for (const Vector3d& moments : {Vector3d(1, 1, 2), Vector3d(2, 2, 0.1), Vector3d(1, 1e-6, 1), Vector3d(3, 3, 3)}) {
    for (int i = 0; i < 10; ++i) {
      const Spin start{random_rotation(random), random_vector(random, 3)};
      const RotationBounds bounds = bound_rotation(state_of(moments, start), finite_inertia(1.0, moments.asDiagonal()), 0.0, 1.0);
      const Fastest seen = fastest(moments, start, 10.0, 200);
      EXPECT_GE(bounds.angular_speed, seen.speed) << moments.transpose();
      // What is seen of a ball's acceleration, 0, is the rounding of w x w: a few eps of |w|^2.
      EXPECT_GE(bounds.angular_acceleration + 4 * kEps * seen.speed * seen.speed, seen.acceleration) << moments.transpose();
    }
  }
}

TEST(RotationBounds, LeaveRoomForATorque) {
  // A ball of inertia 0.5 at rest under 2 N m for 3 s ends at 12 rad/s.
  const RigidBodyState resting{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()};
  const RotationBounds bounds = bound_rotation(resting, finite_inertia(1.0, 0.5 * Matrix3d::Identity()), 2.0, 3.0);
  EXPECT_GE(bounds.angular_speed, 12.0);
  EXPECT_LE(bounds.angular_speed, 12.1);
  EXPECT_GE(bounds.angular_acceleration, 4.0);
}

TEST(RotationBounds, AreZeroAtRest) {
  const RigidBodyState resting{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()};
  const RotationBounds bounds = bound_rotation(resting, finite_inertia(1.0, Matrix3d::Identity()), 0.0, 1.0);
  EXPECT_EQ(bounds.angular_speed, 0.0);
  EXPECT_EQ(bounds.angular_acceleration, 0.0);
}

}  // namespace
}  // namespace tumble::testing
