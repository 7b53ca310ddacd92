// The rotation that takes one direction to another.
#include <numbers>

#include <gtest/gtest.h>

#include "framework/core/shortest_turn.h"

namespace tumble {
namespace {

constexpr double kRoundings = 2e-15;  // a dozen operations on numbers of size 1

Vector3d direction(double angle) { return {std::cos(angle), std::sin(angle), 0.0}; }

TEST(ShortestTurn, TakesOneDirectionToTheOther) {
  for (const double angle : {0.0, 1e-9, 0.3, 1.5, 3.0, 3.1, std::numbers::pi - 1e-3,
                             std::numbers::pi - 1e-6, std::numbers::pi - 1e-10, std::numbers::pi}) {
    const Quaterniond turn = shortest_turn(2.0 * direction(0.7), 3.0 * direction(0.7 + angle));
    EXPECT_NEAR(turn.norm(), 1.0, kRoundings) << angle;
    EXPECT_LT((turn * direction(0.7) - direction(0.7 + angle)).norm(), kRoundings) << angle;
  }
}

TEST(ShortestTurn, TurnsByTheAngleBetweenThem) {
  for (const double angle : {1e-6, 0.3, 1.5, 3.0, std::numbers::pi - 1e-6}) {
    const Quaterniond turn = shortest_turn(direction(0.0), direction(angle));
    EXPECT_NEAR(2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w())), angle, kRoundings * 4.0)
        << angle;
  }
}

TEST(ShortestTurn, OppositeDirectionsAreHalfATurnApart) {
  for (const Vector3d& from :
       {Vector3d(0.0, 0.0, 1.0), Vector3d(0.0, -2.0, 0.0), Vector3d(1.0, 2.0, 3.0)}) {
    const Quaterniond turn = shortest_turn(from, -from);
    EXPECT_NEAR(turn.w(), 0.0, kRoundings);
    EXPECT_NEAR(turn.vec().dot(from.normalized()), 0.0, kRoundings);
    EXPECT_LT((turn * from + from).norm(), kRoundings * from.norm());
  }
}

}  // namespace
}  // namespace tumble
