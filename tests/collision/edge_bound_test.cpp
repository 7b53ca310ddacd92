// Edges that cross and turn: how long they are known to stay apart, and what a search along them
// costs.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "framework/collision/first_impact.h"
#include "framework/collision/time_bound.h"
#include "tests/collision/flights.h"

namespace tumble::testing::edge_bound_test {
namespace {

using collision::CollisionShape;
using collision::Motion;

constexpr double kHalf = 0.5;  // m, of the cubes' sides
const double kArm = std::sqrt(2.0) * kHalf;

CollisionShape cube() { return CollisionShape{Box{Vector3d::Constant(kHalf)}}; }

Quaterniond turn(double angle, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(angle, axis));
}

// A cube stands on an edge along x over a cube that lies with an edge along y, and turns about y:
// its edge slides over the other and comes nearer by 1 - cos. Contact where the centre, H over the
// lower edge, is kArm from it along the turning normal: H cos(w t) = kArm.
TEST(EdgesThatTurn, MeetWhenTheirNormalSaysSoAfterFewSteps) {
  constexpr double kSpeed = 10.0;  // rad/s
  // of the path: what a method of fourth order leaves is no more than the larger one
  for (const auto& [gap, error] :
       {std::pair{1e-4, 0.0}, std::pair{1e-6, 0.0}, std::pair{1e-8, 0.0}, std::pair{1e-8, 1e-9}}) {
    const CollisionShape upper = cube(), lower = cube();
    const double high = kArm + gap;
    const Motion turning = numerical(Vector3d(0.1, 0.0, kArm + high), Vector3d::Zero(),
                                     Vector3d::Zero(), (kSpeed - error) * Vector3d::UnitY(),
                                     error * Vector3d::UnitY(), turn(M_PI / 4, Vector3d::UnitX()));
    const Motion still = flight(Vector3d(0.1, 0.0, 0.0), Vector3d::Zero(), Vector3d::Zero(),
                                Vector3d::Zero(), turn(M_PI / 4, Vector3d::UnitY()));
    collision::ImpactCost cost;
    const auto impact = collision::first_impact(upper, turning, lower, still, 0.0, 0.02, {}, &cost);
    ASSERT_TRUE(impact) << gap;
    // The gap closes at w sqrt(2 gap) kArm at least; its rounding is that of some ten lengths of
    // 1 m.
    const double rounding = 10 * 2.2e-16 / (kSpeed * std::sqrt(2.0 * gap) * kArm);
    EXPECT_NEAR(impact->time, std::acos(kArm / high) / kSpeed, rounding) << gap;
    // Bounds by a fixed normal take a thousand and more: the edge's end goes down at 5 m/s.
    EXPECT_LT(cost.gap_evaluations, 100u) << gap;
  }
}

// Two edges by lot that cross near their middles, at every gap and motion: the gap is not closed at
// any of 40 times within the bound.
TEST(EdgesThatTurn, StayApartWithinTheBound) {
  std::mt19937 lot(7);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(lot); };
  const auto vector = [&] { return Vector3d(number(), number(), number()); };
  int longer = 0;
  for (int k = 0; k < 2000; ++k) {
    const CollisionShape a = cube(), b = cube();
    const double gap = std::pow(10.0, -1.0 - 3.0 * (number() + 1.0));
    const Quaterniond of_a = turn(number(), Vector3d::UnitZ()) *
                             turn(M_PI / 4 + 0.3 * number(), Vector3d::UnitX()),
                      of_b = turn(number(), Vector3d::UnitZ()) *
                             turn(M_PI / 4 + 0.3 * number(), Vector3d::UnitY());
    Vector3d high(0.3 * number(), 0.3 * number(), 0.0);
    high.z() = 3.0;
    collision::Gap apart = collision::compute_gap(a, {high, of_a}, b, {Vector3d::Zero(), of_b});
    high.z() -= (apart.distance - gap) / apart.normal_b_to_a_world.z();
    const double fast = std::pow(10.0, number());
    const Motion motion_a =
                     flight(high, fast * vector(), 10.0 * vector(), 10 * fast * vector(), of_a),
                 motion_b = flight(Vector3d::Zero(), fast * vector(), 10.0 * vector(),
                                   10 * fast * vector(), of_b);
    const double horizon = 0.05;
    const collision::TimeBound bound = collision::bound_time_apart(
        a, motion_a.at(0.0), motion_a.bounds, b, motion_b.at(0.0), motion_b.bounds, horizon);
    for (int i = 1; i <= 40; ++i) {
      const double t = bound.duration * i / 40;
      const double left = collision::gap_distance(a, motion_a.at(t).pose, b, motion_b.at(t).pose);
      // at the bound's end the gap may be closed to the rounding of lengths of 1 m
      ASSERT_GT(left, -1e-14) << "pair " << k << ", at " << i << "/40 of " << bound.duration;
    }
    // Ends of edges go at some 5 `fast`: a fixed normal would say gap / (5 fast).
    if (bound.duration < horizon && bound.duration > 10.0 * gap / (5.0 * fast)) ++longer;
  }
  EXPECT_GT(longer, 200) << "the lot does not try what it is about";
}

}  // namespace
}  // namespace tumble::testing::edge_bound_test
