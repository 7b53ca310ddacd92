// Power series of free turning, against the exact rotation in long double.
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/dynamics/rotation_bounds.h"
#include "framework/dynamics/spin_series.h"
#include "framework/dynamics/world.h"

namespace tumble::testing::spin_series_test {
namespace {

constexpr double kEpsilon = 2.220446049250313e-16;

Vector3d random_vector(Random& random) {
  return {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
}

// Moments of some solid: sums of two of three positive numbers.
Matrix3d random_inertia(Random& random) {
  const Vector3d parts(random.between(0.01, 1), random.between(0.01, 1), random.between(0.01, 1));
  const Matrix3d R =
      Quaterniond(Eigen::AngleAxisd(random.between(0, 3), random_vector(random).normalized()))
          .toRotationMatrix();
  return R *
         Vector3d(parts.y() + parts.z(), parts.z() + parts.x(), parts.x() + parts.y())
             .asDiagonal() *
         R.transpose();
}

TEST(SpinSeries, IsTheExactRotationAsFarAsItReaches) {
  Random random(8);
  for (int k = 0; k < 300; ++k) {
    const Matrix3d inertia = random_inertia(random);
    const FreeRotation exact(0.5 * (inertia + inertia.transpose()));
    ASSERT_TRUE(exact.is_asymmetric());
    const Spin start{
        Quaterniond(Eigen::AngleAxisd(random.between(0, 3), random_vector(random).normalized())),
        random.between(0.1, 50.0) * random_vector(random)};
    RigidBodyState state{Vector3d::Zero(), start.world_from_body, Vector3d::Zero(),
                         start.world_from_body * (inertia * start.omega_body)};
    const double fastest =
                     bound_rotation(
                         state, finite_inertia(1.0, 0.5 * (inertia + inertia.transpose())), {0.0})
                         .angular_speed,
                 reach = SpinSeries::reach(exact.moments(), fastest);
    const SpinSeries series(exact.moments(), exact.body_from_principal(), start);
    for (const double part : {0.0, 0.3, 1.0}) {
      const Spin expected = exact.after(start, part * reach), found = series.at(part * reach);
      // 20 products of numbers below 1 an entry and two changes of frame; a wrong term is off by
      // 1e-3.
      EXPECT_LT((expected.omega_body - found.omega_body).norm(), 20 * kEpsilon * fastest);
      EXPECT_LT((expected.world_from_body.coeffs() - found.world_from_body.coeffs()).norm(),
                20 * kEpsilon);
    }
  }
}

}  // namespace
}  // namespace tumble::testing::spin_series_test
