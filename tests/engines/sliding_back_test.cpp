// Friction turns round where a body that slides stops and slides back: that instant ends a step, and
// what is constant besides is followed exactly, by every engine and with every step.
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/spring/spring.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_runs.h"

namespace tumble::testing {
namespace sliding_back_test {

constexpr double kG = 9.81;

/// A flat box of a kilogram on a plane through the origin that is inclined by `slope` and goes down
/// along x.
scene::Scene box_on_a_slope(double slope, double friction, double speed, double time, double step) {
  const Vector3d normal(std::sin(slope), 0, std::cos(slope)),
      down(std::cos(slope), 0, -std::sin(slope));
  constexpr double kHalfHigh = 0.05;
  std::vector<scene::BodySpec> bodies{
      plane("slope", {0, 0, 0}, normal),
      box("box", {0.4, 0.4, kHalfHigh}, 1.0, kHalfHigh * normal, speed * down)};
  for (scene::BodySpec& body : bodies) {
    body.world_from_body = Eigen::AngleAxisd(slope, Vector3d::UnitY());
    body.restitution = 0.0;
    body.friction = friction;
  }
  scene::Scene scene = scene_of(std::move(bodies), time, kEarth);
  scene.contact.emplace();
  scene.step_s = step;
  return scene;
}

// Up with g (sin + mu cos) against it, back with g (sin - mu cos). Taken with the step, the turn is
// off by up to mu g h, 0.01 m/s at 1/240 s.
TEST(SlidingBack, ABoxThrownUpASlopeComesBackAsItShould) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const double slope = random.between(0.1, 0.8),
                 friction = random.between(0.1, 0.9) * std::tan(slope),
                 speed = random.between(0.5, 3.0), step = round % 2 == 0 ? 1.0 / 60 : 1.0 / 240;
    const double braking = kG * (std::sin(slope) + friction * std::cos(slope)),
                 falling = kG * (std::sin(slope) - friction * std::cos(slope)),
                 up = speed / braking, back = random.between(0.05, 0.4);
    const double expected = falling * back;
    const scene::Scene scene = box_on_a_slope(slope, friction, -speed, up + back, step);
    for (const std::string& engine : kEngines) {
      const Trajectory run = run_well(engine, scene);
      // 1e-9: the solver's residue, 1e-12 of some m/s in each of 100 steps, ten times
      EXPECT_NEAR(run.frames.back().poses[1].velocity_world.norm(), expected, 1e-9)
          << fmt::format("{}, slope {}, friction {}, step {}", engine, slope, friction, step);
    }
  }
}

// x'' = -w^2 x -+ mu g: about one of two points at mu g / w^2 on both sides, by turns.
double swing_with_friction(double start, double w, double friction, double time) {
  const double off = friction * kG / (w * w), half = std::numbers::pi / w;
  double from = start, sign = start > 0 ? 1.0 : -1.0;
  for (; time > half; time -= half, sign = -sign) from = 2 * sign * off - from;
  return sign * off + (from - sign * off) * std::cos(w * time);
}

double error_of_swing(const std::string& engine, double step) {
  constexpr double kStiffness = 60.0, kFriction = 0.05, kStart = 0.3, kTime = 2.0, kAnchor = 2.0;
  scene::Scene scene = box_on_a_slope(0.0, kFriction, 0.0, kTime, step);
  scene.bodies[1].position_m.x() = kStart;
  scene.effects.of<effects::SpringSpec>().push_back(
      {"spring", {"box", Vector3d::Zero()}, {"", {-kAnchor, 0, 0.05}}, kStiffness, 0.0, kAnchor});
  const Trajectory run = run_well(engine, scene);
  return std::abs(run.frames.back().poses[1].com_world.x() -
                  swing_with_friction(kStart, std::sqrt(kStiffness), kFriction, kTime));
}

// Five turns in two seconds. Steps of first order at them leave millimetres.
TEST(SlidingBack, ABoxOnASpringSwingsOutAsItShould) {
  for (const std::string& engine : kEngines) {
    SCOPED_TRACE(engine);
    // m: RK4 leaves (w h)^5 / 120 of the way in each of 120 steps, 1e-5; the rest is of the turns,
    // located to the third power of the step
    EXPECT_LT(error_of_swing(engine, 1.0 / 60), 2e-5);
    EXPECT_LT(error_of_swing(engine, 1.0 / 240), 2e-7);
  }
}

}  // namespace sliding_back_test
}  // namespace tumble::testing
