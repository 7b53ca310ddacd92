// A student's own tests, as good as they need to be. tests/grading/own_tests_of_all.sh hands them
// in.
#include "tests/a3_constraints/a3_fixtures.h"

using namespace tumble;
using a3_testing::a3_module;

namespace {
Body some_body(Vector3d x, Vector3d v, Vector3d w, double angle) {
  Body b;
  b.inertia = finite_inertia(2, Vector3d(1, 2, 3).asDiagonal());
  b.com_world = x;
  b.world_from_body = Quaterniond(Eigen::AngleAxisd(angle, Vector3d(1, 2, 2) / 3));
  b.velocity_world = v;
  b.omega_world = w;
  return b;
}
const Body kA = some_body({1, 2, 3}, {1, -1, 2}, {0.5, 1, -2}, 0.8),
           kB = some_body({-1, 0, 1}, {2, 0, 1}, {1, 2, 0.5}, -0.6);
const Vector3d kPa(0.3, -0.2, 0.5), kPb(-0.4, 0.1, 0.2);
}  // namespace

TEST(Mine, Anchors) {
  const Vector3d r = kA.world_from_body * kPa;
  EXPECT_LT((a3_module().anchor_position(kA, kPa) - (kA.com_world + r)).norm(), 1e-12);
  EXPECT_LT(
      (a3_module().anchor_velocity(kA, kPa) - (kA.velocity_world + kA.omega_world.cross(r))).norm(),
      1e-12);
}
TEST(Mine, Spring) {
  Spring s;
  s.stiffness = 10;
  s.damping = 3;
  s.rest_length = 1;
  AnchorState a, b;
  a.point_world = {0, 0, 0};
  a.velocity_world = {1, 5, 0};
  b.point_world = {0, 2, 0};
  b.velocity_world = {-2, 9, 1};
  EXPECT_LT((a3_module().spring_force(s, a, b) - Vector3d(0, 10 + 12, 0)).norm(), 1e-12);
}
TEST(Mine, RodRow) {
  const ConstraintRow row = a3_module().rod_row(kA, kPa, kB, kPb, 2);
  const Vector3d ra = kA.world_from_body * kPa, rb = kB.world_from_body * kPb;
  const Vector3d d = kA.com_world + ra - kB.com_world - rb, n = d.normalized();
  const Vector3d dd =
      kA.velocity_world + kA.omega_world.cross(ra) - kB.velocity_world - kB.omega_world.cross(rb);
  EXPECT_NEAR(row.value, d.norm() - 2, 1e-12);
  EXPECT_NEAR(row.rate, n.dot(dd), 1e-12);
  EXPECT_LT((row.jacobian_a.head<3>() - n).norm(), 1e-12);
  EXPECT_LT((row.jacobian_a.tail<3>() - ra.cross(n)).norm(), 1e-12);
  EXPECT_LT((row.jacobian_b.head<3>() + n).norm(), 1e-12);
  EXPECT_LT((row.jacobian_b.tail<3>() + rb.cross(n)).norm(), 1e-12);
  const double want = n.dot(kA.omega_world.cross(kA.omega_world.cross(ra)) -
                            kB.omega_world.cross(kB.omega_world.cross(rb))) +
                      (dd.squaredNorm() - n.dot(dd) * n.dot(dd)) / d.norm();
  EXPECT_NEAR(row.velocity_product, want, 1e-12);
}
TEST(Mine, Baumgarte) {
  EXPECT_NEAR(a3_module().baumgarte_acceleration(3, 5, 0.5), -20 - 12, 1e-12);
}
TEST(Mine, AWeightOnARod) {
  Constraint c;
  c.body_a = 0;
  c.body_b = 1;
  c.row.value = 0;
  c.row.rate = 0;
  c.row.velocity_product = 0.7;
  c.row.jacobian_a.setZero();
  c.row.jacobian_b.setZero();
  c.row.jacobian_a(2) = -1;
  c.row.jacobian_b(2) = 1;
  ConstrainedBody a, b;
  a.inverse_mass = 0.5;
  a.inverse_inertia_world = Matrix3d::Identity();
  a.free_acceleration.setZero();
  a.free_acceleration(2) = -10;
  b.inverse_mass = 0;
  b.inverse_inertia_world.setZero();
  b.free_acceleration.setZero();
  const VectorXd l = a3_module().constraint_multipliers({c}, {a, b}, VectorXd::Constant(1, 0.2));
  EXPECT_NEAR(l(0), 2 * (0.2 - 10 - 0.7), 1e-10);
  const VectorXd x = a3_module().constraint_correction({c}, {a, b}, VectorXd::Constant(1, 0.3));
  EXPECT_NEAR(x(2), 0.3, 1e-12);
}
TEST(Mine, ContactsPushOnly) {
  MatrixXd m = MatrixXd::Identity(2, 2);
  VectorXd b(2);
  b << 3, -4;
  const VectorXd f = a3_module().contact_forces(m, b);
  EXPECT_NEAR(f(0), 0, 1e-10);
  EXPECT_NEAR(f(1), 4, 1e-10);
}
TEST(Mine, Rest) {
  EXPECT_TRUE(a3_module().ends_in_contact(0.2, 0.5, 0.1));
  EXPECT_FALSE(a3_module().ends_in_contact(0.3, 0.5, 0.1));
}
