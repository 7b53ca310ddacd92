// Ellipsoid against plane: gap, nearest point and time of impact, compared with closed forms and
// with the surface itself.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "framework/collision/contact_patch.h"
#include "framework/collision/first_impact.h"
#include "framework/collision/manifold_points.h"
#include "framework/collision/time_bound.h"

namespace tumble::testing::ellipsoid_test {
namespace {

using collision::CollisionShape;
using collision::Motion;
using collision::MotionState;
using collision::Pose;

constexpr double kRounding = 1e-14;  // m: dozens of roundings of lengths of about 1 m

const Ellipsoid kEgg{{0.5, 0.3, 0.2}, {0.02, -0.03, 0.1}};

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  Vector3d vector(double size) {
    return {size * number_(engine_), size * number_(engine_), size * number_(engine_)};
  }
  Quaterniond turn() {
    return Quaterniond(number_(engine_), number_(engine_), number_(engine_), number_(engine_))
        .normalized();
  }

 private:
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> number_{-1.0, 1.0};
};

TEST(EllipsoidOverAPlane, TouchesAtAPointOfItsSurfaceWhoseNormalIsThePlanes) {
  const CollisionShape egg{Shape(kEgg)}, plane{Shape(HalfSpace{})};
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Pose pose{random.vector(1.0), random.turn()}, ground{random.vector(1.0), random.turn()};
    const collision::Gap gap = collision::compute_gap(egg, pose, plane, ground);
    const Vector3d n = ground.world_from_body * Vector3d::UnitZ();
    EXPECT_LE((gap.normal_b_to_a_world - n).norm(), kRounding);
    EXPECT_NEAR(n.dot(gap.point_a_world - ground.com_world), gap.distance, kRounding);
    EXPECT_NEAR(n.dot(gap.point_b_world - ground.com_world), 0.0, kRounding);
    // x^2/a^2 + y^2/b^2 + z^2/c^2 = 1; its gradient there points down, against n.
    const Vector3d p =
        pose.world_from_body.conjugate() * (gap.point_a_world - pose.com_world) - kEgg.center_body;
    EXPECT_NEAR(p.cwiseQuotient(kEgg.semi_axes_body).squaredNorm(), 1.0, 1e-13);
    const Vector3d outward =
        pose.world_from_body *
        p.cwiseQuotient(kEgg.semi_axes_body.cwiseProduct(kEgg.semi_axes_body)).normalized();
    EXPECT_LE((outward + n).norm(), 1e-13);
  }
}

TEST(EllipsoidOverAPlane, WithEqualAxesIsABall) {
  const CollisionShape round{Shape(Ellipsoid{Vector3d::Constant(0.3)})}, ball{Shape(Sphere{0.3})},
      plane{Shape(HalfSpace{})};
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    const Pose pose{random.vector(1.0), random.turn()}, ground{random.vector(1.0), random.turn()};
    EXPECT_NEAR(collision::compute_gap(round, pose, plane, ground).distance,
                collision::compute_gap(ball, pose, plane, ground).distance, kRounding);
    EXPECT_NEAR(collision::compute_gap(plane, ground, round, pose).distance,
                collision::compute_gap(ball, pose, plane, ground).distance, kRounding);
  }
}

TEST(EllipsoidOverAPlane, HasOneContactPointEvenWhenItLiesFlat) {
  const CollisionShape egg{Shape(kEgg)}, plane{Shape(HalfSpace{})};
  const Pose lying{{0.0, 0.0, 0.1}, Quaterniond::Identity()};  // its centre at 0.2 = c
  const collision::Gap gap = collision::compute_gap(egg, lying, plane, Pose{});
  EXPECT_NEAR(gap.distance, 0.0, kRounding);
  EXPECT_EQ(collision::contact_patch(egg, lying, plane, Pose{}, gap, 1e-3).corners.size(), 1u);
  const auto points = collision::manifold_points(egg, lying, plane, Pose{}, 1e-3);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_LE((points[0].point_a_world - Vector3d(0.02, -0.03, 0.0)).norm(), kRounding);
  EXPECT_TRUE(
      collision::manifold_points(egg, {{0, 0, 0.2}, Quaterniond::Identity()}, plane, Pose{}, 1e-3)
          .empty());
}

Motion flight(const Vector3d& x, const Vector3d& v, double g, const Vector3d& omega,
              const Quaterniond& q) {
  Motion motion;
  motion.at = [=](double t) {
    MotionState state;
    state.pose.com_world = x + t * v - Vector3d(0, 0, 0.5 * g * t * t);
    state.pose.world_from_body =
        omega.isZero(0) ? q
                        : Quaterniond(Eigen::AngleAxisd(omega.norm() * t, omega.normalized())) * q;
    state.velocity_world = v - Vector3d(0, 0, g * t);
    state.omega_world = omega;
    return state;
  };
  motion.bounds.acceleration_world = Vector3d(0, 0, -g);
  motion.bounds.angular_speed = omega.norm();
  return motion;
}

// Its centre is fixed at a height between the semi-axes c and a. It rotates about y and touches
// where sqrt(a^2 sin^2 + c^2 cos^2) equals that height.
TEST(EllipsoidOverAPlane, HasAnImpactWhenItRotatesIntoThePlane) {
  const Ellipsoid centred{{0.5, 0.3, 0.2}};
  const CollisionShape shape{Shape(centred)}, plane{Shape(HalfSpace{})};
  constexpr double height = 0.4, omega = 3.0;
  const double angle = std::asin(std::sqrt((height * height - 0.04) / (0.25 - 0.04)));
  const auto impact = collision::first_impact(
      shape, flight({0, 0, height}, Vector3d::Zero(), 0.0, {0, omega, 0}, Quaterniond::Identity()),
      plane,
      flight(Vector3d::Zero(), Vector3d::Zero(), 0.0, Vector3d::Zero(), Quaterniond::Identity()),
      0.0, 1.0);
  ASSERT_TRUE(impact);
  // rounding of the height divided by the rate, 0.3 m/s
  EXPECT_NEAR(impact->time, angle / omega, 1e-14);
  EXPECT_GE(impact->gap.distance, 0.0);
  const auto none = collision::first_impact(
      shape, flight({0, 0, 0.5001}, Vector3d::Zero(), 0.0, {0, omega, 0}, Quaterniond::Identity()),
      plane,
      flight(Vector3d::Zero(), Vector3d::Zero(), 0.0, Vector3d::Zero(), Quaterniond::Identity()),
      0.0, 10.0);
  EXPECT_FALSE(none);  // higher than its longest semi-axis
}

// No contact within the bound, tested at a thousand instants; and the bound is not trivial:
// conservative advancement makes progress.
TEST(EllipsoidOverAPlane, StaysApartWithinTheTimeBound) {
  const CollisionShape egg{Shape(kEgg)}, plane{Shape(HalfSpace{})};
  const Motion ground =
      flight(Vector3d::Zero(), Vector3d::Zero(), 0.0, Vector3d::Zero(), Quaterniond::Identity());
  Random random(3);
  int bounded = 0;
  for (int k = 0; k < 300; ++k) {
    const Quaterniond q = random.turn();
    const double up = collision::compute_gap(egg, {Vector3d::Zero(), q}, plane, Pose{}).distance;
    const Motion motion =
        flight({0, 0, 0.05 * (k % 5) - up}, random.vector(2.0), 9.81, random.vector(8.0), q);
    const collision::TimeBound bound = collision::bound_time_apart(
        egg, motion.at(0.0), motion.bounds, plane, ground.at(0.0), ground.bounds, 0.5);
    EXPECT_NEAR(bound.gap, 0.05 * (k % 5), kRounding);
    bounded += bound.duration > 1e-3 && bound.duration < 0.5;
    for (int i = 0; i <= 1000; ++i) {
      const double t = bound.duration * i / 1000;
      ASSERT_GE(collision::compute_gap(egg, motion.at(t).pose, plane, Pose{}).distance, -kRounding)
          << "case " << k << ", t = " << t << " of " << bound.duration;
    }
  }
  EXPECT_GE(bounded, 150);
}

}  // namespace
}  // namespace tumble::testing::ellipsoid_test
