// Hidden: repairs and Euler angles on seeded random rotations, and in and near gimbal lock.
#include <Eigen/QR>

#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

constexpr double kRightAngle = M_PI / 2;

Matrix3d turned(double yaw, double pitch, double roll) {
  using Eigen::AngleAxisd;
  return AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix() *
         AngleAxisd(pitch, Vector3d::UnitY()).toRotationMatrix() *
         AngleAxisd(roll, Vector3d::UnitX()).toRotationMatrix();
}

std::string angles(const a2::EulerAngles& a) {
  return show(a.yaw) + ", " + show(a.pitch) + ", " + show(a.roll) + " rad";
}

TEST(Renormalize, TakesQuaternionsOfAnyLength) {
  Random random(41);
  for (const double length : {1e-8, 0.3, 1.0 + 1e-15, 7.0, 1e8}) {
    const Quaterniond q = random_rotation(random);
    const Quaterniond found = a2_module().renormalize(Quaterniond(length * q.coeffs()));
    expect_near(Eigen::Vector4d(found.coeffs()), Eigen::Vector4d(q.coeffs()), 10 * kEps,
                "(x y z w)",
                {.scene = "a random rotation, scaled to length " + show(length),
                 .slip = "no renormalising, or a first-order repair only",
                 .handout = equation(6)});
  }
}

TEST(Orthonormalize, GivesTheOneAnswerOfGramSchmidt) {
  // Gram-Schmidt is the QR factorisation with a positive diagonal, which is unique; Householder
  // finds it another way.
  Random random(42);
  for (int i = 0; i < 50; ++i) {
    Matrix3d drifted = random_rotation(random).toRotationMatrix();
    for (int k = 0; k < 3; ++k) drifted.col(k) += random_vector(random, 0.2);
    const Eigen::HouseholderQR<Matrix3d> qr(drifted);
    Matrix3d expected = qr.householderQ();
    for (int k = 0; k < 3; ++k)
      if (qr.matrixQR()(k, k) < 0) expected.col(k) *= -1;
    expect_near(
        a2_module().orthonormalize(drifted), expected, 100 * kEps, "",
        {.scene = "a random rotation with random drift of up to 0.2, number " + std::to_string(i),
         .slip = "the second projection is not taken off the third column, or rows are taken for "
                 "columns",
         .handout = equation(7)});
  }
}

TEST(EulerAngles, ComeBackFromAnyAngles) {
  Random random(43);
  for (int i = 0; i < 100; ++i) {
    const double yaw = random.between(-M_PI, M_PI), pitch = random.between(-1.5, 1.5),
                 roll = random.between(-M_PI, M_PI);
    const Story story{
        .scene = "yaw " + show(yaw) + ", pitch " + show(pitch) + ", roll " + show(roll) + " rad",
        .slip = "the order of the turns, or atan for atan2",
        .handout = equation(8)};
    expect_near(a2_module().rotation_from_euler_angles(yaw, pitch, roll), turned(yaw, pitch, roll),
                20 * kEps, "", story);
    const a2::EulerAngles found = a2_module().euler_angles_from_rotation(turned(yaw, pitch, roll));
    // cos(pitch) >= 0.07 divides the rounding of the entries.
    expect_near(vector({found.yaw, found.pitch, found.roll}), vector({yaw, pitch, roll}),
                20 * kEps / 0.07, "rad", story);
  }
}

TEST(EulerAngles, PassThroughGimbalLockWithoutLosingTheRotation) {
  Random random(44);
  for (const double off : {0.0, 1e-16, 1e-12, 1e-9, 0.9e-8, 1.1e-8, 1e-7, 1e-5, 2e-3, 0.1}) {
    for (const double sign : {1.0, -1.0}) {
      const double yaw = random.between(-3, 3), roll = random.between(-3, 3);
      const Matrix3d R = turned(yaw, sign * (kRightAngle - off), roll);
      const a2::EulerAngles found = a2_module().euler_angles_from_rotation(R);
      const Story story{
          .scene = "yaw " + show(yaw) + " rad, pitch " + show(off) + " rad short of " +
                   (sign > 0 ? "+" : "-") + "90 degrees, roll " + show(roll) + " rad; found " +
                   angles(found),
          .slip = "gimbal lock: where cos(pitch) < 1e-8, roll = 0 and yaw = atan2(-R_01, R_11)",
          .handout = equation(9)};
      // rounding eps / cos(pitch), or what the convention leaves out
      const double allowed = off > 1e-3 ? 1e-12 : 2e-8;
      expect_near(turned(found.yaw, found.pitch, found.roll), R, allowed, "", story);
      if (off < 1e-9) expect_near(found.roll, 0.0, 0.0, "rad (roll)", story);
    }
  }
}

TEST(EulerAngles, BearAnEntryRoundedBeyondOne) {
  Matrix3d R;
  const double beyond = 1 + 4 * kEps;
  R << 0, 0, beyond, 0, 1, 0, -beyond, 0, 0;
  const a2::EulerAngles found = a2_module().euler_angles_from_rotation(R);
  expect_near(vector({found.yaw, found.pitch, found.roll}), vector({0, kRightAngle, 0}), 3e-8,
              "rad (yaw, pitch, roll)",
              {.scene = "pitch 90 degrees, R_20 = -1 - 9e-16",
               .slip = "asin of a number beyond 1 is NaN: use atan2(-R_20, c)",
               .handout = equation(9)});
}

}  // namespace
}  // namespace tumble::a2_testing
