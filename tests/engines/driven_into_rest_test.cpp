// What is driven into a ball at rest, without persistent contacts, in all four engines: walls, a
// plate and a plane from below. Velocities and places after the impact in closed form.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/engines/driven_scenes.h"
#include "tests/engines/event_scenes.h"

namespace tumble::testing {
namespace driven_into_rest_test {

constexpr double kG = 9.81, kRadius = 0.1, kRestitution = 0.5;
// m and m/s of about 1: some hundred roundings of the time of impact, and of RK4's steps. Without
// the impact the ball is off by 0.1.
constexpr double kTolerance = 1e-10;

struct After {
  double time;      // of the impact [s]
  double velocity;  // of the ball after it, along the wall's way [m/s]
};

After after(double time, double speed_of_wall) {
  return {time, (1 + kRestitution) * speed_of_wall};
}

Trajectory run_in(const std::string& engine, const scene::Scene& scene) {
  const Trajectory run = run_by(engine, scene);
  EXPECT_EQ(run.stopped_by, "") << engine;
  return run;
}

void expect_the_references_traces(const scene::Scene& scene) {
  const Trajectory ordered = run_in("ordered", scene);
  for (const char* engine : {"ca", "tw"}) {
    SCOPED_TRACE(engine);
    EXPECT_EQ(difference(ordered, run_in(engine, scene)), "");
  }
}

// Along x the floor, without friction, does nothing.
void expect_pushed_along(const scene::Scene& scene, const After& expected) {
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    const Trajectory run = run_in(engine, scene);
    const Frame& end = run.frames.back();
    EXPECT_NEAR(end.poses[1].velocity_world.x(), expected.velocity, kTolerance);
    EXPECT_NEAR(end.poses[1].com_world.x(), expected.velocity * (end.time - expected.time),
                kTolerance);
    EXPECT_GE(end.smallest_gap, -kTolerance);
  }
  expect_the_references_traces(scene);
}

TEST(DrivenIntoRest, AWallPushesABallThatHasLainFromTheStart) {
  expect_pushed_along(ball_and_driven(driven(wall_with_face_at(-0.4), {1.0, 0, 0}), 0.0, 0.5),
                      after(0.3, 1.0));
}

TEST(DrivenIntoRest, AWallPushesABallThatHasFallenAndComeToRest) {
  expect_pushed_along(ball_and_driven(driven(wall_with_face_at(-0.6), {1.0, 0, 0}), 0.1, 0.7),
                      after(0.5, 1.0));
}

// It comes and goes as A sin(w t), and meets the ball where that is A / 2. The ball is faster than
// it ever is.
TEST(DrivenIntoRest, AShakenWallPushesTheBallAndLeaves) {
  const double amplitude = 0.2, frequency = 5.0;
  const double time = std::asin(0.5) / frequency,
               speed = amplitude * frequency * std::cos(frequency * time);
  expect_pushed_along(ball_and_driven(driven(wall_with_face_at(-kRadius - 0.5 * amplitude),
                                             Vector3d::Zero(), {amplitude, 0, 0}, frequency),
                                      0.0, 0.6),
                      after(time, speed));
}

// Up through the floor: the top is 0.1 m below it, and the ball flies from there on. It would meet
// what rises again 0.051 s later.
void expect_lifted(const scene::BodySpec& rising) {
  const scene::Scene scene = ball_and_driven(driven(rising, {0, 0, 0.5}), 0.0, 0.24);
  const After expected = after(0.2, 0.5);
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    const Frame end = run_in(engine, scene).frames.back();
    const double s = end.time - expected.time;
    EXPECT_NEAR(end.poses[1].velocity_world.z(), expected.velocity - kG * s, kTolerance);
    EXPECT_NEAR(end.poses[1].com_world.z(), kRadius + expected.velocity * s - 0.5 * kG * s * s,
                kTolerance);
  }
  expect_the_references_traces(scene);
}

TEST(DrivenIntoRest, APlateFromBelowLiftsTheBall) {
  expect_lifted(box("plate", {0.5, 0.5, 0.05}, 1.0, {0, 0, -0.15}, Vector3d::Zero()));
}

TEST(DrivenIntoRest, APlaneFromBelowLiftsTheBall) {
  expect_lifted(plane("plane", {0, 0, -0.1}, Vector3d::UnitZ()));
}

// A wall that turns before the ball, a wall that goes by at some distance, and a plane that stays
// below the floor.
TEST(DrivenIntoRest, ABallThatNothingMeetsKeepsItsPlaceToTheLastBit) {
  const scene::BodySpec passing = wall_with_face_at(-0.4),
                        below = plane("plane", {0, 0, -0.2}, Vector3d::UnitZ());
  for (const scene::BodySpec& other :
       {driven(passing, Vector3d::Zero(), {0.25, 0, 0}, 5.0), driven(passing, {-0.5, 0, 0}),
        driven(below, Vector3d::Zero(), {0, 0, 0.15}, 5.0)})
    for (const std::string& engine : kEngines) {
      SCOPED_TRACE(engine);
      const Trajectory run = run_in(engine, ball_and_driven(other, 0.0, 1.0));
      for (const Frame& frame : run.frames) {
        EXPECT_EQ(frame.poses[1].com_world, Vector3d(0, 0, kRadius));
        EXPECT_TRUE(frame.poses[1].velocity_world.isZero(0.0));
      }
      // s: it comes to rest, in rd once it has met the floor to a rounding
      for (const Event& event : run.events) EXPECT_LT(event.time, 1e-6);
    }
}

// Far from the ball, that a wall moves costs what it costs that it stands. The ordered reference
// checks all pairs, and this one at each window.
TEST(DrivenIntoRest, AWallFarAwayCostsNothing) {
  const scene::BodySpec wall = wall_with_face_at(-3.0);
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    const auto count = [&](const Vector3d& velocity, const char* what) {
      return run_in(engine, ball_and_driven(driven(wall, velocity), 0.0, 1.0))
          .counters.counts.at(what);
    };
    EXPECT_EQ(count({1.0, 0, 0}, "gap_evaluations"), count(Vector3d::Zero(), "gap_evaluations"));
    if (engine == std::string("ordered")) continue;
    EXPECT_EQ(count({1.0, 0, 0}, "pair_checks"), count(Vector3d::Zero(), "pair_checks"));
  }
}

}  // namespace driven_into_rest_test
}  // namespace tumble::testing
