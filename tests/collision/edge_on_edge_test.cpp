// Two edges that lie along each other have a range of contact normals: the one returned must not
// depend on the last digit of their position.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "framework/collision/gap.h"
#include "framework/collision/manifold_points.h"

namespace tumble::testing {
namespace {

using collision::CollisionShape;
using collision::ManifoldPoint;
using collision::Pose;

constexpr double kEps = 2.220446049250313e-16;
constexpr double kLean = 0.4;    // rad, of each card from upright
constexpr double kReach = 1e-4;  // m
const Vector3d kHalf(0.005, 0.5, 0.5);
// Angles are computed from sums and products of a few numbers of size 1.
constexpr double kRoundOff = 64 * kEps;

/// A card whose upper inner edge lies along y through `top`, leaning to the side of `side` x.
Pose card(double side, const Vector3d& top, double lean = kLean) {
  const Quaterniond turn(Eigen::AngleAxisd(-side * lean, Vector3d::UnitY()));
  return {top - turn * Vector3d(-side * kHalf.x(), 0, kHalf.z()), turn};
}

std::vector<ManifoldPoint> points_of_tent(const Vector3d& right_from_left,
                                          double lean_right = kLean) {
  const CollisionShape shape{Box{kHalf}};
  return collision::manifold_points(shape, card(1, right_from_left, lean_right), shape,
                                    card(-1, Vector3d::Zero()), kReach);
}

TEST(EdgeOnEdge, NormalIsTheMiddleOneWhereverTheEdgesLieWithinTheMargin) {
  for (const double apart : {1e-12, 1e-10, 1e-8})
    for (const double direction : {-1.5, -0.8, 0.0, 0.3, 1.2}) {  // rad above the horizontal
      const std::vector<ManifoldPoint> points =
          points_of_tent(apart * Vector3d(std::cos(direction), 0, std::sin(direction)));
      ASSERT_EQ(points.size(), 2u)
          << "the two ends of the edge; " << apart << " m apart, at " << direction << " rad";
      for (const ManifoldPoint& p : points) {
        // From the left card to the right one; both normal cones extend by kLean to either side.
        EXPECT_LE((p.normal_b_to_a_world - Vector3d::UnitX()).norm(), kRoundOff);
        EXPECT_NEAR(p.gap, apart * std::cos(direction), kRoundOff);
        EXPECT_NEAR(std::abs(p.point_a_world.y()), 0.5, kRoundOff);
      }
    }
}

// One card rotated slightly about the vertical: one end of its edge may penetrate the other card
// while the other end is apart from it.
TEST(EdgeOnEdge, EachEndHasItsOwnGap) {
  const CollisionShape shape{Box{kHalf}};
  for (const double turn : {-8e-7, -1e-8, 3e-7, 8e-7})  // rad
    for (const double apart : {-1e-7, 1e-10, 1e-7}) {   // m, at the middle of the edge
      Pose right = card(1, Vector3d(apart, 0, 3e-8));
      const Quaterniond about_z(Eigen::AngleAxisd(turn, Vector3d::UnitZ()));
      right = {about_z * right.com_world, about_z * right.world_from_body};
      const std::vector<ManifoldPoint> points =
          collision::manifold_points(shape, right, shape, card(-1, Vector3d::Zero()), kReach);
      ASSERT_EQ(points.size(), 2u) << turn << " rad, " << apart << " m";
      EXPECT_LT(points[0].point_a_world.y() * points[1].point_a_world.y(), 0.0);
      for (const ManifoldPoint& p : points)
        EXPECT_NEAR(p.gap, apart - turn * p.point_a_world.y(), 1e-12)
            << "error: rotation times lengths of 1e-7; " << turn << " rad, " << apart << " m";
    }
}

TEST(EdgeOnEdge, NormalOfCardsAtDifferentAnglesIsTheMiddleOfBothCones) {
  // The left card's edge has normals from -0.4 to pi/2 - 0.4 about y, the right one's from 0.1 -
  // pi/2 to 0.1: the intersection is from -0.4 to 0.1.
  const std::vector<ManifoldPoint> points = points_of_tent({1e-10, 0, 0}, 0.1);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_LE((points[0].normal_b_to_a_world - Vector3d(std::cos(-0.15), 0, std::sin(-0.15))).norm(),
            kRoundOff);
}

TEST(EdgeOnEdge, BeyondAMillionthTheNearestPointsDefineTheNormal) {
  const double direction = 0.3;
  const std::vector<ManifoldPoint> points =
      points_of_tent(1e-5 * Vector3d(std::cos(direction), 0, std::sin(direction)));
  ASSERT_FALSE(points.empty());
  // The difference of coordinates of size 1 is 1e-5 m.
  EXPECT_LE((points[0].normal_b_to_a_world - Vector3d(std::cos(direction), 0, std::sin(direction)))
                .norm(),
            kRoundOff / 1e-5);
}

TEST(EdgeOnEdge, GapIsNeverMeasuredThroughTheSolids) {
  std::mt19937_64 random(27);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  // m; rad: the angle that a box occupies about its edge
  constexpr double kApart = 1e-10, kRight = M_PI / 2;
  int of_edges = 0;
  for (int k = 0; k < 400; ++k) {
    // Each box has an edge along y through the origin and occupies a right angle from of_a or of_b;
    // the two never overlap.
    const double of_a = between(-M_PI, M_PI), of_b = of_a + between(1.02 * kRight, 2.98 * kRight);
    const auto placed = [&](const Vector3d& half, double angle, const Vector3d& edge) {
      const Quaterniond turn(Eigen::AngleAxisd(-angle, Vector3d::UnitY()));  // from x towards z
      return Pose{edge + turn * Vector3d(half.x(), 0, half.z()), turn};
    };
    const Vector3d half_a(between(0.005, 0.5), 0.5, between(0.005, 0.5)),
        half_b(between(0.005, 0.5), 0.4, between(0.005, 0.5));
    const double middle = 0.5 * (of_a + of_b + kRight);  // middle of the free angle from A to B
    const CollisionShape a{Box{half_a}}, b{Box{half_b}};
    // apart or overlapping
    for (const double shift : {kApart, -kApart, 1e-8, -1e-8, 3e-7, -3e-7}) {
      const Pose pose_a =
                     placed(half_a, of_a, shift * Vector3d(std::cos(middle), 0, std::sin(middle))),
                 pose_b = placed(half_b, of_b, Vector3d::Zero());
      const std::vector<ManifoldPoint> points =
          collision::manifold_points(a, pose_a, b, pose_b, 1e-5);
      ASSERT_FALSE(points.empty());
      for (const ManifoldPoint& p : points) {
        EXPECT_GE(p.gap, -std::abs(shift) - kRoundOff) << "angles " << of_a << " and " << of_b;
        if (p.gap < 2 * kApart) ++of_edges;
      }
    }
  }
  EXPECT_GT(of_edges, 400);  // two ends for most boxes
}

TEST(EdgeOnEdge, FlushBoxesHaveTheNormalOfTheirFaces) {
  const CollisionShape box{Box{Vector3d(0.5, 0.4, 0.1)}};
  // m: flush, nearly flush, and with only an edge in contact
  for (const double aside : {0.0, 1e-9, 1.0}) {
    const std::vector<ManifoldPoint> points =
        collision::manifold_points(box, {Vector3d(aside, 0, 0.2 + 1e-10)}, box, {}, kReach);
    ASSERT_FALSE(points.empty());
    for (const ManifoldPoint& p : points)
      if (aside < 1) {
        EXPECT_LE((p.normal_b_to_a_world - Vector3d::UnitZ()).norm(), kRoundOff);
      }
  }
}

// Faces that meet only in a line, as in a pile of bricks: rounding puts them 1e-17 m apart, and the
// contact lay in the middle of one of the faces, where the other body is not.
TEST(EdgeOnEdge, FacesThatMeetInALineTouchAlongIt) {
  const CollisionShape box{Box{Vector3d::Constant(0.05)}};
  const Pose upper{Vector3d(0.4, 0, 0.8)}, shelf{Vector3d(0.3, 0, 0.7)};
  for (const bool is_upper_first : {true, false}) {
    const std::vector<ManifoldPoint> points = collision::manifold_points(
        box, is_upper_first ? upper : shelf, box, is_upper_first ? shelf : upper, kReach);
    ASSERT_FALSE(points.empty());
    for (const ManifoldPoint& p : points) {
      EXPECT_NEAR(p.point_a_world.x(), 0.35, kRoundOff);
      EXPECT_NEAR(p.point_a_world.z(), 0.75, kRoundOff);
      EXPECT_NEAR(std::abs(p.point_a_world.y()), 0.05, kRoundOff);
      EXPECT_NEAR(p.gap, 0.0, kRoundOff);
    }
  }
}

TEST(EdgeOnEdge, TippingBoxHasContactPointsAtTheDescendingEdge) {
  const CollisionShape box{Box{Vector3d(0.5, 0.4, 0.1)}};
  const double tilt = 1e-5;  // rad, about its lower edge at x = -0.5
  const Quaterniond turn(Eigen::AngleAxisd(-tilt, Vector3d::UnitY()));
  const Vector3d edge(-0.5, 0, 0.1 + 1e-10);
  const std::vector<ManifoldPoint> points = collision::manifold_points(
      box, {edge - turn * Vector3d(-0.5, 0, -0.1), turn}, box, {}, kReach);
  int down = 0, coming = 0;
  for (const ManifoldPoint& p : points) (p.point_a_world.x() < 0 ? down : coming) += 1;
  EXPECT_EQ(down, 2);
  EXPECT_EQ(coming, 2);
  for (const ManifoldPoint& p : points)
    EXPECT_NEAR(p.gap, p.point_a_world.x() < 0 ? 1e-10 : tilt, 0.6 * tilt)
        << "the normal is tilted by half the angle";
}

TEST(EdgeOnEdge, NormalOfCrossingEdgesIsPerpendicularToBoth) {
  const CollisionShape box{Box{Vector3d(0.5, 0.5, 0.5)}};
  const Quaterniond on_edge(Eigen::AngleAxisd(0.25 * 3.14159265358979323846, Vector3d::UnitY()));
  for (const double angle : {1e-3, 0.5}) {
    const Quaterniond above = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ())) * on_edge;
    const std::vector<ManifoldPoint> points =
        collision::manifold_points(box, {Vector3d(0, 0, 2 * std::sqrt(0.5) + 1e-10), above}, box,
                                   {Vector3d::Zero(), on_edge}, 1e-7);
    ASSERT_FALSE(points.empty());
    for (const ManifoldPoint& p : points)
      EXPECT_LE((p.normal_b_to_a_world - Vector3d::UnitZ()).norm(), kRoundOff / angle);
  }
}

}  // namespace
}  // namespace tumble::testing
