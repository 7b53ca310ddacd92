// Solids that turn beside each other and hardly come nearer or part: what a search along them finds
// and costs.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "framework/collision/first_impact.h"
#include "framework/collision/time_bound.h"
#include "tests/collision/flights.h"
#include "tests/collision/hulls.h"

namespace tumble::testing::parting_test {
namespace {

using collision::CollisionShape;
using collision::Motion;

class Lot {
 public:
  explicit Lot(unsigned seed) : random_(seed) {}
  double number() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  Vector3d vector() { return {number(), number(), number()}; }
  Quaterniond orientation() {
    return Quaterniond(number(), number(), number(), number()).normalized();
  }

 private:
  std::mt19937 random_;
};

// A ball lies 1e-8 m over the middle of a plate, which turns about an axis in its middle plane: the
// plate's face stays at its height over that axis, and the ball's centre, h + gap from it, comes
// down to h where cos(w t) = h / (h + gap). The plate's corners go at 20 m/s.
TEST(BallOverAPlateThatTurns, IsMetAfterFewSteps) {
  constexpr double kSpeed = 20.0, kThick = 0.1, kRadius = 0.2, kGap = 1e-8;  // rad/s, m
  const CollisionShape plate(Box{Vector3d(1.0, 1.0, kThick)}), ball(Sphere{kRadius});
  const double h = kThick + kRadius;
  for (const double error : {0.0, 1e-9}) {
    const Motion turning = numerical(Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(),
                                     (kSpeed - error) * Vector3d::UnitX(),
                                     error * Vector3d::UnitX(), Quaterniond::Identity()),
                 still = flight(Vector3d(0.0, 0.0, h + kGap), Vector3d::Zero(), Vector3d::Zero(),
                                Vector3d::Zero());
    collision::ImpactCost cost;
    const auto impact = collision::first_impact(plate, turning, ball, still, 0.0, 0.02, {}, &cost);
    ASSERT_TRUE(impact);
    // the gap closes at w sqrt(2 h gap); its rounding is that of some ten lengths of 1 m
    const double rounding = 10 * 2.2e-16 / (kSpeed * std::sqrt(2.0 * h * kGap));
    EXPECT_NEAR(impact->time, std::acos(h / (h + kGap)) / kSpeed, rounding);
    // 256 plain ones, before the search looks closer, and a few; without that some thousand
    EXPECT_LT(cost.gap_evaluations, 400u) << "error " << error;
  }
}

// Balls, cubes and rocks by lot at every gap, motion and error of their path's turning: the gap is
// not closed at any of 40 times within the bound.
TEST(SolidsThatTurn, StayApartWithinTheBoundOfTheirFrames) {
  Lot lot(11);
  const CollisionShape shapes[] = {CollisionShape(Sphere{0.4}),
                                   CollisionShape(Box{Vector3d(0.5, 0.4, 0.3)}),
                                   CollisionShape(random_hull(12, 3))};
  int longer = 0;
  for (int k = 0; k < 3000; ++k) {
    const CollisionShape &a = shapes[k % 3], &b = shapes[1 + k % 2];
    const double gap = std::pow(10.0, -1.0 - 3.0 * (lot.number() + 1.0));
    const Quaterniond of_a = lot.orientation(), of_b = lot.orientation();
    Vector3d place = 3.0 * lot.vector().normalized();
    for (int round = 0; round < 60; ++round) {
      const collision::Gap apart =
          collision::compute_gap(a, {place, of_a}, b, {Vector3d::Zero(), of_b});
      place -= (apart.distance - gap) * apart.normal_b_to_a_world;
    }
    const double fast = std::pow(10.0, lot.number()), error = std::pow(10.0, 3 * lot.number() - 5);
    const Motion motion_a = numerical(place, fast * lot.vector(), 10.0 * lot.vector(),
                                      10 * fast * lot.vector(), error * lot.vector(), of_a),
                 motion_b = numerical(Vector3d::Zero(), fast * lot.vector(), 10.0 * lot.vector(),
                                      10 * fast * lot.vector(), error * lot.vector(), of_b);
    const double horizon = 0.05;
    const auto bound = [&](collision::Effort effort) {
      return collision::bound_time_apart(a, motion_a.at(0.0), motion_a.bounds, b, motion_b.at(0.0),
                                         motion_b.bounds, horizon, nullptr, effort)
          .duration;
    };
    const double duration = bound(collision::Effort::kMore);
    EXPECT_GE(duration, bound(collision::Effort::kUsual));
    for (int i = 1; i <= 40; ++i) {
      const double t = duration * i / 40;
      const double left = collision::gap_distance(a, motion_a.at(t).pose, b, motion_b.at(t).pose);
      // at the bound's end the gap may be closed to the rounding of lengths of 1 m
      ASSERT_GT(left, -1e-14) << "pair " << k << ", at " << i << "/40 of " << duration;
    }
    if (duration > 10.0 * bound(collision::Effort::kUsual)) ++longer;
  }
  EXPECT_GT(longer, 200) << "the lot does not try what it is about";
}

// A ball that touches a rock, as far as numbers say it, and parts from it at 1 mm/s, as after a
// micro-impact: within two microseconds nothing meets, though by the first advances, some 2e-14 s
// long, it has parted by less than the rounding of the gap. At 10 m/s^2 and 20 rad/s paths bend by
// 1e-9 m/s in that time.
TEST(SolidsThatPart, DoNotMeetWhereRoundingClosesTheirGap) {
  Lot lot(5);
  const CollisionShape ball(Sphere{0.3}), rock(random_hull(12, 3));
  int touching = 0, met = 0;
  for (int k = 0; k < 4000; ++k) {
    const Quaterniond of_rock = lot.orientation();
    Vector3d place = 2.0 * lot.vector().normalized();
    collision::Gap gap{};
    for (int round = 0; round < 60; ++round) {
      gap = collision::compute_gap(ball, {place, Quaterniond::Identity()}, rock,
                                   {Vector3d::Zero(), of_rock});
      if (round < 50 || gap.distance < 0.0) place -= gap.distance * gap.normal_b_to_a_world;
    }
    if (!(gap.distance >= 0.0 && gap.distance < 1e-16)) continue;
    ++touching;
    const Vector3d omega = 2.0 * lot.vector(), n = gap.normal_b_to_a_world;
    const Vector3d with_it = omega.cross(gap.point_b_world), along = lot.vector().cross(n);
    const Motion moving = flight(place,
                                 with_it - n.dot(with_it) * n + along + (n.dot(with_it) + 1e-3) * n,
                                 Vector3d::Zero(), Vector3d::Zero()),
                 turning =
                     flight(Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), omega, of_rock);
    if (collision::first_impact(ball, moving, rock, turning, 0.0, 1.6e-6)) ++met;
  }
  EXPECT_EQ(met, 0);
  EXPECT_GT(touching, 1000) << "the lot does not try what it is about";
}

}  // namespace
}  // namespace tumble::testing::parting_test
