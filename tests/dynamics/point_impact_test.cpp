// The impulse of one impact with restitution and friction: closed forms, and what must hold for
// every inverse effective mass.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/dynamics/point_impact.h"

namespace tumble::point_impact_test {
namespace {

constexpr double kRounding = 1e-12;  // some hundred roundings of numbers of the size of 1

Vector3d random_vector(Random& random) {
  return {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
}

/// K of rank 1 to 3: sums of so many a a^T.
Matrix3d random_inverse_mass(Random& random, int rank) {
  Matrix3d K = Matrix3d::Zero();
  for (int i = 0; i < rank; ++i) {
    const Vector3d a = random_vector(random);
    K += a * a.transpose();
  }
  return K;
}

TEST(PointImpact, OfABallOnAFloorStopsTheSlipOrTakesWhatFrictionAllows) {
  // A ball of 1 kg: K_nn = 1, K_tt = 7/2. Sticking takes 2/7 of the slip, sliding mu (1 + e) v.
  Matrix3d K = Matrix3d::Identity() * 3.5;
  K(2, 2) = 1.0;
  const Vector3d n(0, 0, 1), velocity(0.7, 0, -2);
  const auto impulse = [&](double mu) {
    return impulse_of({K, velocity, n, 1.5 * 2.0, mu}).impulse_on_a_world;
  };
  EXPECT_LT((impulse(1.0) - Vector3d(-0.2, 0, 3)).norm(), kRounding);
  EXPECT_LT((impulse(0.05) - Vector3d(-0.15, 0, 3)).norm(), kRounding);
  EXPECT_LT((impulse(0.0) - Vector3d(0, 0, 3)).norm(), kRounding);
}

TEST(PointImpact, InAPlaneFrictionChangesTheNormalImpulseByTheCoupling) {
  // Slides to the end along +x: p_n (K_nn - mu K_nt) = rise, p_t = -mu p_n.
  Matrix3d K;
  K << 2.0, 0, 0.8, 0, 3.0, 0, 0.8, 0, 1.5;
  const Vector3d n(0, 0, 1), velocity(10.0, 0, -1);
  const double mu = 0.25, rise = 1.5, normal = rise / (1.5 - mu * 0.8);
  const PointImpulse found = impulse_of({K, velocity, n, rise, mu});
  EXPECT_EQ(found.friction_share, 1.0);
  EXPECT_LT((found.impulse_on_a_world - Vector3d(-mu * normal, 0, normal)).norm(), kRounding);
}

TEST(PointImpact, FrictionThatWouldCreateEnergyIsTakenAsFarAsItCreatesNone) {
  // Kane and Levinson: the normal impulse drags the contact point back along x, friction then
  // pushes it on. e = 1.
  Matrix3d K;
  K << 2.0, 0, 1.5, 0, 2.0, 0, 1.5, 0, 2.0;
  const Vector3d n(0, 0, 1), velocity(-0.2, 0, -1);
  const double rise = 2.0;
  const PointImpulse found = impulse_of({K, velocity, n, rise, 1.0});
  EXPECT_LT(found.friction_share, 1.0);
  EXPECT_LE(energy_of(found.impulse_on_a_world, velocity, K), 1e-14);
  EXPECT_NEAR(n.dot(K * found.impulse_on_a_world), rise, kRounding);
}

TEST(PointImpact, ObeysRestitutionTheConeAndEnergyForEveryInverseMass) {
  Random random(7);
  int sticks = 0, slides = 0, limited = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const int rank = 1 + trial % 3;
    const Matrix3d K = random_inverse_mass(random, rank);
    const Vector3d n = random_vector(random).normalized();
    if (n.dot(K * n) < 1e-3) continue;
    // A velocity that the bodies can have: in the range of K where they are held.
    Vector3d velocity = K * random_vector(random);
    if (n.dot(velocity) > 0) velocity = -velocity;
    const double e = trial % 7 == 0 ? 1.0 : random.between(0, 1), mu = random.between(0, 2),
                 rise = -(1 + e) * n.dot(velocity);
    const PointImpulse found = impulse_of({K, velocity, n, rise, mu});
    const Vector3d& p = found.impulse_on_a_world;
    const double size = velocity.norm() + (K * p).norm(), normal = n.dot(p);
    const Vector3d tangential = p - normal * n, after = velocity + K * p,
                   slip = after - n.dot(after) * n;
    ASSERT_TRUE(p.allFinite()) << trial;
    EXPECT_NEAR(n.dot(after), -e * n.dot(velocity), 1e-11 * size) << trial;
    EXPECT_LE(tangential.norm(), mu * normal * (1 + 1e-12)) << trial;
    EXPECT_LE(energy_of(p, velocity, K), 1e-12 * size * p.norm()) << trial;
    if (found.friction_share < 1.0) {
      ++limited;
      continue;
    }
    if (tangential.norm() < mu * normal * (1 - 1e-9)) {
      ++sticks;
      // K of two nearly equal directions loses some digits
      EXPECT_LT(slip.norm(), 1e-9 * size) << trial << " rank " << rank;
    } else {
      ++slides;
      EXPECT_LT((slip.norm() * tangential + tangential.norm() * slip).norm(),
                1e-9 * size * tangential.norm())
          << trial << " rank " << rank;
    }
  }
  EXPECT_GT(sticks, 1000);
  EXPECT_GT(slides, 1000);
  EXPECT_GT(limited, 100);
}

}  // namespace
}  // namespace tumble::point_impact_test
