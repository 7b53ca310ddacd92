// Orientations that have drifted (A2.6), (A2.7), and Euler angles (A2.8), (A2.9).
#include "tests/a2_integration/a2_fixtures.h"

namespace tumble::a2_testing {
namespace {

constexpr double kRightAngle = M_PI / 2;

const VectorXd numbers(const Quaterniond& q) { return vector({q.w(), q.x(), q.y(), q.z()}); }

TEST(Renormalize, GivesUnitLength) {
  const Quaterniond found = a2_module().renormalize({1.5, -1.5, 4.5, -0.5});  // of length 5
  const Slips<Quaterniond> slips = {
      {{1.5, -1.5, 4.5, -0.5}, "no renormalising at all"},
      {Quaterniond(0.06, -0.06, 0.18, -0.02), "divided by |q|^2: the root is missing"}};
  expect_near(numbers(found), vector({0.3, -0.3, 0.9, -0.1}), kRoundoff, "(w x y z)",
              {.scene = "q = (1.5, -1.5, 4.5, -0.5), of length 5",
               .slip = likely(found, slips, "q / |q|"),
               .handout = equation(6)});
}

TEST(Renormalize, RepairsASmallDriftWithoutTurningAround) {
  const double drift = 1 + 1e-6;
  const Quaterniond q(-0.5, 0.5, -0.5, 0.5);
  const Quaterniond found =
      a2_module().renormalize({-0.5 * drift, 0.5 * drift, -0.5 * drift, 0.5 * drift});
  const Slips<Quaterniond> slips = {
      {{0.5, -0.5, 0.5, -0.5}, "q and -q turn alike, but do not jump from one to the other"}};
  expect_near(numbers(found), numbers(q), kRoundoff, "(w x y z)",
              {.scene = "q = (1 + 1e-6) (-0.5, 0.5, -0.5, 0.5)",
               .slip = likely(found, slips, "no renormalising, or a first-order repair only"),
               .handout = equation(6)});
}

TEST(Renormalize, RepairsAnyLength) {
  const Quaterniond q(0.2, 0.4, -0.8, 0.4);
  for (const double length : {1 + 1e-9, 1 - 0x1p-40, 0x1p-60, 0x1p60}) {
    const Quaterniond given(length * q.coeffs()), found = a2_module().renormalize(given);
    const Slips<Quaterniond> slips = {{Quaterniond::Identity(),
                                       "an absolute threshold: only the zero quaternion has no "
                                       "direction, however short another is"}};
    const std::string otherwise = numbers(found) == numbers(given)
                                      ? "left as it is: every drift is repaired, however small"
                                      : "q / |q|";
    expect_near(numbers(found), numbers(q), kRoundoff, "(w x y z)",
                {.scene = "(0.2, 0.4, -0.8, 0.4), a unit quaternion, times " + show_scale(length) +
                          (std::abs(length - 1) < 0.5 ? " (1 + " + show(length - 1) + ")" : ""),
                 .slip = likely(found, slips, otherwise),
                 .handout = equation(6),
                 .iterates = true});
  }
}

TEST(Orthonormalize, TakesOffProjectionsColumnByColumn) {
  Matrix3d drifted, only_first, scaled;
  // columns (2,0,0), (3,5,0), (4,6,7): Gram-Schmidt gives the unit axes
  drifted << 2, 3, 4, 0, 5, 6, 0, 0, 7;
  only_first << 1, 0, 0, 0, 1, 6 / std::sqrt(85.0), 0, 0, 7 / std::sqrt(85.0);
  scaled = drifted.colwise().normalized();
  const Matrix3d found = a2_module().orthonormalize(drifted);
  expect_near(
      found, Matrix3d(Matrix3d::Identity()), kRoundoff, "",
      {.scene = "columns (2, 0, 0), (3, 5, 0), (4, 6, 7)",
       .slip = likely(
           found,
           Slips<Matrix3d>{
               {only_first, "the second projection is not taken off the third column: (y . c) y"},
               {scaled, "the columns are made unit, but no projection is taken off"},
               {Vector3d(1, 1, -1).asDiagonal(),
                "left-handed axes: the third column is x cross y, not y cross x"},
               {drifted, "nothing is done"}},
           "columns or rows: the columns of R are the body's axes; a comes first"),
       .handout = equation(7)});
}

/// A mistake whose whole matrix came, or what to look at.
Mistake slip_of_columns(const Matrix3d& found, const Matrix3d& drifted) {
  const Vector3d a = drifted.col(0), b = drifted.col(1), c = drifted.col(2), x = a.normalized(),
                 y = (b - x.dot(b) * x).normalized();
  const auto of = [](const Vector3d& first, const Vector3d& second, const Vector3d& third) {
    Matrix3d m;
    m << first, second, third;
    return m;
  };
  const auto off = [](const Vector3d& v, const Vector3d& direction) {
    return Vector3d(v - direction.dot(v) * direction);
  };
  return likely(
      found,
      Slips<Matrix3d>{{of(x, y, off(c, x).normalized()),
                       "the second projection is not taken off the third column: (y . c) y"},
                      {of(x, y, off(c, y).normalized()),
                       "the first projection is not taken off the third column: (x . c) x"},
                      {of(x, y, c.normalized()), "no projection is taken off the third column"},
                      {of(x, off(b, x), off(off(c, x), off(b, x).normalized())),
                       "columns that are not made unit"},
                      {Matrix3d(drifted.colwise().normalized()),
                       "the columns are made unit, but no projection is taken off"},
                      {drifted, "nothing is done"}},
      "(x . b) x, (x . c) x and (y . c) y are taken off, and each column is then made unit");
}

TEST(Orthonormalize, RepairsADriftedRotation) {
  Matrix3d drift;
  drift << 3, -1, 2, 4, 2, -3, -2, 5, 1;
  const Matrix3d drifted = third_turn().toRotationMatrix() + 1e-4 * drift;
  const Matrix3d R = a2_module().orthonormalize(drifted);
  const Story story{
      .scene = "a rotation matrix whose entries have drifted by up to 5e-4",
      .slip = slip_of_columns(R, drifted),
      .handout = equation(7),
      .iterates = true};  // a drift of 5e-4 leaves errors of its square, as large as float's
  expect_near(Matrix3d(R.transpose() * R), Matrix3d(Matrix3d::Identity()), kRoundoff, "(R^T R)",
              story);
  expect_near(R.determinant(), 1.0, kRoundoff, "(determinant)", story);
  expect_near(
      R.col(0), drifted.col(0).normalized(), kRoundoff, "(first column)",
      {.scene = story.scene,
       .slip = "the first column keeps its direction: start with it, and take columns, not rows",
       .handout = equation(7)});
  expect_near(R.col(1).dot(drifted.col(0).cross(drifted.col(1)).normalized()), 0.0, kRoundoff,
              "(second column off the plane of a and b)",
              {.scene = story.scene,
               .slip = "the second column stays in the plane of a and b",
               .handout = equation(7)});
}

TEST(Orthonormalize, RepairsAnyDrift) {
  Matrix3d drift;
  drift << 3, -1, 2, 4, 2, -3, -2, 5, 1;
  for (const double size : {1e-8, 0x1p-36}) {
    const Matrix3d drifted = third_turn().toRotationMatrix() + size * drift,
                   R = a2_module().orthonormalize(drifted);
    expect_near(
        Matrix3d(R.transpose() * R), Matrix3d(Matrix3d::Identity()), kRoundoff, "(R^T R)",
        {.scene = "a rotation matrix whose entries have drifted by up to " + show_scale(5 * size),
         .slip = R == drifted ? "left as it is: every drift is repaired, however small"
                              : "Gram-Schmidt, column by column",
         .handout = equation(7),
         .iterates = true});
  }
  for (const double size : {0x1p-60, 0x1p60}) {
    const Matrix3d R = third_turn().toRotationMatrix(),
                   found = a2_module().orthonormalize(size * (R + 1e-3 * drift)),
                   plain = a2_module().orthonormalize(R + 1e-3 * drift);
    expect_near(found, plain, kRoundoff, "",
                {.scene = "a drifted rotation matrix, all of it times " + show_scale(size),
                 .slip = "an absolute threshold: columns of any length have a direction",
                 .handout = equation(7)});
  }
}

TEST(EulerAngles, EachTurnsItsOwnAxis) {
  Matrix3d yaw, pitch, roll;
  yaw << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pitch << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  roll << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const auto check = [](const std::string& name, const Matrix3d& found, const Matrix3d& expected) {
    const Matrix3d in_degrees =
        Eigen::AngleAxisd(kRightAngle * M_PI / 180, name == "yaw"     ? Vector3d::UnitZ()
                                                    : name == "pitch" ? Vector3d::UnitY()
                                                                      : Vector3d::UnitX())
            .toRotationMatrix();
    expect_near(
        found, expected, kRoundoff, "",
        {.scene = name + " of 90 degrees alone",
         .slip = likely(found,
                        Slips<Matrix3d>{
                            {expected.transpose(),
                             "the sense of the turn is wrong: a positive angle turns right-handed"},
                            {in_degrees, "degrees taken for radians"}},
                        "yaw turns about z, pitch about y, roll about x"),
         .handout = equation(8)});
  };
  check("yaw", a2_module().rotation_from_euler_angles(kRightAngle, 0, 0), yaw);
  check("pitch", a2_module().rotation_from_euler_angles(0, kRightAngle, 0), pitch);
  check("roll", a2_module().rotation_from_euler_angles(0, 0, kRightAngle), roll);
}

TEST(EulerAngles, YawComesFirstAndCarriesTheOtherAxes) {
  const Matrix3d found = a2_module().rotation_from_euler_angles(kRightAngle, 0, kRightAngle);
  Matrix3d expected, reversed;  // the nose (body x) points along world y; body y points up
  expected << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  reversed << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  expect_near(
      found, expected, kRoundoff, "",
      {.scene =
           "yaw 90 degrees, then roll 90 degrees about the nose, which yaw has turned to world y",
       .slip = likely(found,
                      Slips<Matrix3d>{{reversed,
                                       "the order of the turns is wrong: R_z(yaw) R_y(pitch) "
                                       "R_x(roll), roll nearest to the body"}},
                      "R_z(yaw) R_y(pitch) R_x(roll)"),
       .handout = equation(8)});
}

TEST(EulerAngles, ComeBackFromTheMatrix) {
  const a2::EulerAngles found = a2_module().euler_angles_from_rotation(
      Eigen::AngleAxisd(2.5, Vector3d::UnitZ()).toRotationMatrix() *
      Eigen::AngleAxisd(-0.7, Vector3d::UnitY()).toRotationMatrix() *
      Eigen::AngleAxisd(-3.0, Vector3d::UnitX()).toRotationMatrix());
  const VectorXd angles = vector({found.yaw, found.pitch, found.roll});
  expect_near(
      angles, vector({2.5, -0.7, -3.0}), 10 * kRoundoff, "rad (yaw, pitch, roll)",
      {.scene = "the matrix of yaw 2.5, pitch -0.7, roll -3.0 rad",
       .slip = likely(
           angles,
           Slips<VectorXd>{
               {vector({2.5 - M_PI, -0.7, -3.0 + M_PI}), "atan for atan2: the quadrant is lost"},
               {vector({-3.0, -0.7, 2.5}), "yaw and roll are swapped"},
               {vector({2.5, 0.7, -3.0}), "the sign of pitch is wrong: R_20 = -sin(pitch)"}},
           "atan2 of the entries named in the equation"),
       .handout = equation(9)});
}

TEST(EulerAngles, AreNumbersWhereRoundingExceedsOne) {
  for (const double sign : {1.0, -1.0}) {
    const double beyond = sign * (1 + 4 * kEps);
    Matrix3d R;
    R << 0, 0, beyond, 0, 1, 0, -beyond, 0, 0;
    const a2::EulerAngles found = a2_module().euler_angles_from_rotation(R);
    const std::string of_asin = "asin of a number beyond 1 is NaN: use atan2(-R_20, c)";
    expect_near(vector({found.yaw, found.pitch, found.roll}), vector({0, sign * kRightAngle, 0}),
                3e-8, "rad (yaw, pitch, roll)",
                {.scene = "pitch " + std::string(sign > 0 ? "+" : "-") +
                          "90 degrees, where rounding has made |R_20| 1 + 9e-16",
                 .slip = "gimbal lock: roll = 0 and yaw = atan2(-R_01, R_11)",
                 .handout = equation(9),
                 .no_number = of_asin});
  }
}

TEST(EulerAngles, GimbalLockKeepsTheRotation) {
  for (const double pitch_sign : {1.0, -1.0}) {
    // Yaw 0.5 and roll 0.3 at pitch +-90 degrees: only yaw -+ roll is left.
    const double turn = 0.5 - pitch_sign * 0.3;
    Matrix3d R;
    R << 0, -std::sin(turn), pitch_sign * std::cos(turn), 0, std::cos(turn),
        pitch_sign * std::sin(turn), -pitch_sign, 0, 0;
    const a2::EulerAngles found = a2_module().euler_angles_from_rotation(R);
    expect_near(
        vector({found.yaw, found.pitch, found.roll}), vector({turn, pitch_sign * kRightAngle, 0}),
        1e-8, "rad (yaw, pitch, roll)",
        {.scene =
             "yaw 0.5, pitch " + std::string(pitch_sign > 0 ? "+" : "-") + "90 degrees, roll 0.3",
         .slip = "gimbal lock: where cos(pitch) < 1e-8, roll = 0 and yaw = atan2(-R_01, R_11)",
         .handout = equation(9),
         .no_number = "a division by cos(pitch) = 0"});
  }
}

}  // namespace
}  // namespace tumble::a2_testing
