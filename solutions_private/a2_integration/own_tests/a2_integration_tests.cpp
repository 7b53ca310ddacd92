// A student's own tests, as good as they need to be. tests/grading/own_tests_of_all.sh hands them
// in.
#include "tests/a2_integration/a2_fixtures.h"

using namespace tumble;
using a2_testing::a2_module;

namespace {
VectorXd one(double x) {
  VectorXd v(1);
  v << x;
  return v;
}
Quaterniond turn(double angle, Vector3d axis) {
  return Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}
}  // namespace

TEST(Mine, EulerFollowsTheSlope) {
  const auto f = [](double t, const VectorXd& y) -> VectorXd { return one(3 * t + y(0)); };
  EXPECT_NEAR(a2_module().euler_step(f, 2, one(5), 0.5)(0), 5 + 0.5 * 11, 1e-12);
}
TEST(Mine, Rk4OfAPolynomialInTime) {
  const auto f = [](double t, const VectorXd&) -> VectorXd { return one(t * t * t + t); };
  EXPECT_NEAR(a2_module().rk4_step(f, 1, one(2), 1)(0), 2 + 15.0 / 4 + 1.5, 1e-12);
}
TEST(Mine, Rk4OfAnExponential) {
  const auto f = [](double, const VectorXd& y) -> VectorXd { return y; };
  const double h = 0.5;
  EXPECT_NEAR(a2_module().rk4_step(f, 0, one(1), h)(0),
              1 + h + h * h / 2 + h * h * h / 6 + h * h * h * h / 24, 1e-12);
}
TEST(Mine, Rk4OfAMixedEquation) {
  const auto f = [](double t, const VectorXd& y) -> VectorXd { return one(t * y(0)); };
  const double h = 0.4, k1 = 1.0 * 2, k2 = (1 + h / 2) * (2 + h / 2 * k1),
               k3 = (1 + h / 2) * (2 + h / 2 * k2), k4 = (1 + h) * (2 + h * k3);
  EXPECT_NEAR(a2_module().rk4_step(f, 1, one(2), h)(0), 2 + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4),
              1e-12);
}
TEST(Mine, InertiaTurnsWithTheBody) {
  Matrix3d i = Vector3d(1, 2, 4).asDiagonal();
  const Quaterniond q = turn(0.7, {1, 2, 3});
  const Matrix3d r = q.toRotationMatrix();
  EXPECT_LT((a2_module().inertia_in_world(i, q) - r * i * r.transpose()).norm(), 1e-12);
}
TEST(Mine, DerivativeOfATurnedBody) {
  RigidBodyState s;
  s.com_world = {1, 2, 3};
  s.world_from_body = turn(0.7, {1, 2, 3});
  s.momentum_world = {4, 6, 8};
  s.angular_momentum_world = {1, -2, 3};
  const Inertia inertia = finite_inertia(2, Vector3d(1, 2, 4).asDiagonal());
  const Matrix3d r = s.world_from_body.toRotationMatrix();
  const Vector3d w =
      r * (inertia.inverse_inertia_body * (r.transpose() * s.angular_momentum_world));
  const Quaterniond qd = Quaterniond(0, w.x(), w.y(), w.z()) * s.world_from_body;
  const VectorXd y = a2_module().rigid_body_derivative(s, inertia, {{7, 8, 9}, {10, 11, 12}});
  const double want[13] = {2, 3, 4, qd.w() / 2, qd.x() / 2, qd.y() / 2, qd.z() / 2,
                           7, 8, 9, 10,         11,         12};
  for (int i = 0; i < 13; ++i) EXPECT_NEAR(y(i), want[i], 1e-12) << i;
}
TEST(Mine, RenormalizeGivesUnitLength) {
  const Quaterniond q = a2_module().renormalize(Quaterniond(2, 0, 0, 1));
  EXPECT_NEAR(q.norm(), 1, 1e-14);
  EXPECT_NEAR(q.w() / q.z(), 2, 1e-13);
}
TEST(Mine, EulerAnglesThereAndBack) {
  const double yaw = 0.3, pitch = -0.4, roll = 2.5;
  const Matrix3d r =
      (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
       Eigen::AngleAxisd(roll, Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((a2_module().rotation_from_euler_angles(yaw, pitch, roll) - r).norm(), 1e-12);
  const auto e = a2_module().euler_angles_from_rotation(r);
  EXPECT_NEAR(e.yaw, yaw, 1e-12);
  EXPECT_NEAR(e.pitch, pitch, 1e-12);
  EXPECT_NEAR(e.roll, roll, 1e-12);
}
TEST(Mine, BothSearchesFindTheRoot) {
  const auto g = [](double t) { return 4 - t * t; };
  const auto r = [](double t) { return -2 * t; };
  const auto b = a2_module().impact_time_bisection(g, 0, 5, 1e-10);
  const auto n = a2_module().impact_time_newton(g, r, 0.1, 5, 1e-10);
  EXPECT_EQ(b.status, RootStatus::kConverged);
  EXPECT_EQ(n.status, RootStatus::kConverged);
  EXPECT_NEAR(b.time, 2, 1e-9);
  EXPECT_NEAR(n.time, 2, 1e-9);
  EXPECT_GE(g(b.time), 0);
  EXPECT_GE(g(n.time), 0);
}
TEST(Mine, OverlapFromTheStartIsNoImpact) {
  const auto g = [](double t) { return t - 1; };
  EXPECT_EQ(a2_module().impact_time_bisection(g, 0, 2, 1e-9).status, RootStatus::kNoSignChange);
  EXPECT_EQ(a2_module().impact_time_bisection(g, 1.5, 2, 1e-9).status, RootStatus::kNoSignChange);
}
