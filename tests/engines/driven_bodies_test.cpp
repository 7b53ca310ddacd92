// Bodies that move by a law of their own (rising, sinking, shaken floors, belts, walls that push,
// anchors) with persistent contact and friction, in all four engines. Outcomes in closed form.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "framework/dynamics/world.h"
#include "framework/effects/rod/rod.h"
#include "tests/engines/event_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

constexpr double kG = 9.81;
const Vector3d kGravity(0, 0, -kG);

const Laws& laws() {
  static const Laws all = reference_laws();
  return all;
}

scene::BodySpec driven_plane(const std::string& name, const Vector3d& velocity,
                             const Vector3d& amplitude = Vector3d::Zero(), double frequency = 0.0,
                             const Vector3d& normal = Vector3d::UnitZ()) {
  scene::BodySpec body = plane(name, Vector3d::Zero(), normal);
  body.motion = scene::PrescribedMotion{velocity, amplitude, frequency};
  return body;
}

scene::Scene with_contact(std::vector<scene::BodySpec> bodies, double duration, double friction,
                          double restitution) {
  for (scene::BodySpec& body : bodies) {
    body.friction = friction;
    body.restitution = restitution;
  }
  scene::Scene scene = scene_of(std::move(bodies), duration, kGravity);
  scene.contact = scene::ContactSpec{};
  scene.step_s = 1.0 / 240;
  return scene;
}

Trajectory run_in(const std::string& engine, const scene::Scene& scene) {
  const Trajectory run = run_by(engine, scene, {}, 60.0, laws());
  EXPECT_EQ(run.stopped_by, "") << engine;
  return run;
}

// Impacts of a ball dropped from `height` on a floor that is at floor(t) with the velocity
// speed(t).
std::vector<double> impacts_on(const std::function<double(double)>& floor,
                               const std::function<double(double)>& speed, double height, double e,
                               double duration) {
  std::vector<double> times;
  double t0 = 0.0, z = height, v = 0.0;
  while (true) {
    const auto gap = [&](double t) {
      return z + v * (t - t0) - 0.5 * kG * (t - t0) * (t - t0) - floor(t);
    };
    double low = t0 + 1e-6, high = low;
    while (high < duration && gap(high) > 0) {
      low = high;
      high += 1e-4;
    }
    if (high >= duration) return times;
    for (int k = 0; k < 100; ++k) (gap(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    const double before = v - kG * (low - t0);
    z = floor(low);
    v = speed(low) + e * (speed(low) - before);
    t0 = low;
    times.push_back(low);
  }
}

// Rising, sinking, and shaken up and down. Each impact doubles what rounding leaves of the one
// before, at most: 1e-11 s after ten.
TEST(DrivenFloors, ABallBouncesWhereTheyAreWhenItComes) {
  struct Case {
    double velocity, amplitude, frequency, e;
  };
  for (const Case& c : {Case{0.5, 0, 0, 0.8},
                        {-1.0, 0, 0, 1.0},
                        {0, 0.05, 10, 0.8},
                        {0, 0.1, 10, 1.0},
                        {0.2, 0.02, 15, 0.7}}) {
    const double radius = 0.1, duration = 1.5;
    const auto floor = [&](double t) {
      return c.velocity * t + c.amplitude * std::sin(c.frequency * t);
    };
    const auto speed = [&](double t) {
      return c.velocity + c.amplitude * c.frequency * std::cos(c.frequency * t);
    };
    const std::vector<double> expected = impacts_on(floor, speed, 1.0, c.e, duration);
    ASSERT_GE(expected.size(), 1u);
    const scene::Scene scene =
        with_contact({driven_plane("floor", {0, 0, c.velocity}, {0, 0, c.amplitude}, c.frequency),
                      ball("ball", radius, 1.0, {0, 0, 1.0 + radius}, Vector3d::Zero())},
                     duration, 0.3, c.e);
    for (const std::string& engine : kEngines) {
      const std::vector<double> times = collision_times(run_in(engine, scene));
      ASSERT_EQ(times.size(), expected.size())
          << engine << ", velocity " << c.velocity << ", amplitude " << c.amplitude;
      for (std::size_t k = 0; k < times.size(); ++k)
        EXPECT_NEAR(times[k], expected[k], 1e-10) << engine << ", impact " << k;
    }
  }
}

// A ball set on a belt is dragged by mu g until it rolls on it: v = 2/7 V for a full ball.
TEST(DrivenFloors, ABallOnABeltIsDraggedUntilItRolls) {
  const double speed = 2.0, mu = 0.3, radius = 0.1;
  const scene::Scene scene =
      with_contact({driven_plane("belt", {speed, 0, 0}),
                    ball("ball", radius, 1.0, {0, 0, radius}, Vector3d::Zero())},
                   1.0, mu, 0.0);
  const double rolls = 2.0 / 7 * speed / (mu * kG),
               way = 0.5 * mu * kG * rolls * rolls + 2.0 / 7 * speed * (1.0 - rolls);
  for (const std::string& engine : kEngines) {
    const BodyPose end = run_in(engine, scene).frames.back().poses[1];
    EXPECT_NEAR(end.velocity_world.x(), 2.0 / 7 * speed, 1e-9) << engine;
    // m; the end of sliding is located to a millionth of the step
    EXPECT_NEAR(end.com_world.x(), way, 1e-8) << engine;
  }
}

// A box set on a belt is dragged by mu g until it moves along.
TEST(DrivenFloors, ABoxOnABeltIsDraggedUntilItMovesAlong) {
  const double speed = 1.5, mu = 0.4;
  const scene::Scene scene =
      with_contact({driven_plane("belt", {speed, 0, 0}),
                    box("box", {0.2, 0.2, 0.05}, 2.0, {0, 0, 0.05}, Vector3d::Zero())},
                   1.0, mu, 0.0);
  const double sticks = speed / (mu * kG),
               way = speed * (1.0 - sticks) + 0.5 * mu * kG * sticks * sticks;
  for (const std::string& engine : kEngines) {
    const BodyPose end = run_in(engine, scene).frames.back().poses[1];
    EXPECT_NEAR(end.velocity_world.x(), speed, 1e-9) << engine;
    EXPECT_NEAR(end.com_world.x(), way, 1e-8) << engine;
  }
}

// Shaken along x with less than friction can hold, a box stays where it stands on the floor.
TEST(DrivenFloors, ABoxIsCarriedByAFloorThatIsShakenSideways) {
  const double amplitude = 0.02, frequency = 10.0, mu = 0.5;  // A w^2 = 2 < mu g
  scene::BodySpec carried =
      box("box", {0.2, 0.2, 0.05}, 2.0, {0, 0, 0.05}, {amplitude * frequency, 0, 0});
  scene::Scene scene =
      with_contact({driven_plane("floor", Vector3d::Zero(), {amplitude, 0, 0}, frequency), carried},
                   1.0, mu, 0.0);
  for (const std::string& engine : kEngines) {
    double worst[2];
    for (int k = 0; k < 2; ++k) {
      scene.step_s = 1.0 / (240 << k);
      const Frame end = run_in(engine, scene).frames.back();
      worst[k] = std::abs(end.poses[1].com_world.x() - amplitude * std::sin(frequency * 1.0));
    }
    // Each step goes along the mean of its ends' velocities: A (w h)^2 / 12 a radian, with the
    // square of the step.
    EXPECT_LT(worst[0], 2e-5) << engine;
    EXPECT_LT(worst[1], 0.3 * worst[0] + 1e-9) << engine;
  }
}

// A wall that comes along pushes a block before it, over a floor with friction. Without restitution
// the block takes the wall's velocity.
TEST(DrivenWalls, PushABlockBeforeThem) {
  const double speed = 0.8, mu = 0.3, h = 0.1;
  scene::BodySpec wall =
      driven_plane("wall", {speed, 0, 0}, Vector3d::Zero(), 0.0, Vector3d::UnitX());
  const scene::Scene scene =
      with_contact({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()), wall,
                    box("block", {h, h, h}, 2.0, {0.4 + h, 0, h}, Vector3d::Zero())},
                   1.0, mu, 0.0);
  for (const std::string& engine : kEngines) {
    const BodyPose end = run_in(engine, scene).frames.back().poses[2];
    EXPECT_NEAR(end.velocity_world.x(), speed, 1e-9) << engine;
    EXPECT_NEAR(end.com_world.x(), speed * 1.0 + h, 1e-8) << engine;
    EXPECT_NEAR(end.com_world.z(), h, 1e-8) << engine;
  }
}

/// Everything that is driven, and everything that moves, goes along with V besides. @pre no link
/// ends in the world, nothing is driven yet
scene::Scene moving_along(scene::Scene scene, const Vector3d& V) {
  for (scene::BodySpec& body : scene.bodies)
    if (body.immovable)
      body.motion = scene::PrescribedMotion{V, Vector3d::Zero(), 0.0};
    else
      body.velocity_m_s += V;
  return scene;
}

scene::BodySpec hook(const Vector3d& position) {
  scene::BodySpec body = ball("hook", 0.02, 1.0, position, Vector3d::Zero());
  body.immovable = true;
  body.mass_kg.reset();
  return body;
}

// Galileo: what happens among bodies is the same seen from a train. A bob on a rod, a box that
// lands on a floor, a ball that strikes the bob and the wall; friction and contact everywhere, and
// the rod hangs from a body that goes along.
TEST(DrivenBodies, ATrainMovesAsTheStation) {
  scene::Scene scene =
      with_contact({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()), hook({0, 0, 1.5}),
                    ball("bob", 0.1, 1.0, {0, 0, 0.5}, Vector3d::Zero()),
                    ball("ball", 0.1, 0.7, {-1.0, 0.02, 1.0}, {3.0, 0, 0}),
                    box("box", {0.1, 0.1, 0.1}, 1.0, {1.0, 0, 0.3}, {0.5, 0, 0})},
                   0.6, 0.3, 0.5);
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"hook", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1.0});
  scene.stabilisation = scene::StabilisationSpec{};
  for (const Vector3d& V : {Vector3d(0.5, 0, 0), Vector3d(0.25, -0.5, 1.0)})
    for (const std::string& engine : kEngines) {
      const Trajectory station = run_in(engine, scene),
                       train = run_in(engine, moving_along(scene, V));
      const double duration = station.frames.back().time;
      ASSERT_EQ(collision_times(station).size(), collision_times(train).size()) << engine;
      for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyPose &here = station.frames.back().poses[i],
                       &there = train.frames.back().poses[i];
        // m; impacts of a box that turns double what rounding leaves
        EXPECT_LT((there.com_world - duration * V - here.com_world).norm(), 1e-7)
            << engine << ' ' << scene.bodies[i].name << " V " << V.transpose();
        EXPECT_LT((there.velocity_world - V - here.velocity_world).norm(), 1e-6)
            << engine << ' ' << scene.bodies[i].name;
      }
    }
}

// Two small balls, one on the other, on a floor that shakes with less than g: what does not bounce
// stays on it. The floor's speed changes by twice the restitution threshold in a step, so that who
// takes it for that of the step's end sees the ball come down on it for ever.
TEST(DrivenFloors, SmallBallsStayOnAFloorThatShakesGently) {
  // m, rad/s: a w^2 = 4.3 m/s^2
  const double radius = 0.006, amplitude = 6e-4, frequency = 85.0, duration = 0.2;
  scene::Scene scene =
      with_contact({driven_plane("floor", Vector3d::Zero(), {0, 0, amplitude}, frequency),
                    ball("low", radius, 1e-3, {0, 0, radius + 1e-3}, Vector3d::Zero()),
                    ball("high", radius, 2e-3, {0, 0, 3 * radius + 1.5e-3}, Vector3d::Zero())},
                   duration, 0.5, 0.0);
  scene.step_s = 0.001;
  for (const std::string& engine : kEngines) {
    const Trajectory run = run_in(engine, scene);
    EXPECT_LT(run.counters.counts.at("steps"), 1000u) << engine;  // 200, and some for each impact
    const double floor = amplitude * std::sin(frequency * run.frames.back().time);
    // m: the floor bends by a w^3 h^3 / 12 = 3e-8 from the parabola of a step
    EXPECT_NEAR(run.frames.back().poses[1].com_world.z(), floor + radius, 5e-8) << engine;
    EXPECT_NEAR(run.frames.back().poses[2].com_world.z(), floor + 3 * radius, 5e-8) << engine;
  }
}

// On a floor that is shaken up and down with up to g, what does not bounce lies still on it: the
// floor's way bends from what its velocities at a step's ends say, and the ball goes along, strikes
// nothing and stays at the margin.
TEST(DrivenFloors, WhatLiesOnThemFollowsTheirWay) {
  const double frequency = 4 * M_PI;
  for (const double part : {0.9, 1.0})
    for (const double step : {1.0 / 60, 1.0 / 120}) {
      const double amplitude = part * kG / (frequency * frequency);
      scene::Scene scene =
          with_contact({driven_plane("floor", Vector3d::Zero(), {0, 0, amplitude}, frequency),
                        ball("ball", 0.1, 1.0, {0, 0, 0.1}, {0, 0, amplitude * frequency})},
                       1.0, 0.0, 0.0);
      scene.step_s = step;
      for (const std::string& engine : kEngines) {
        const Trajectory run = run_in(engine, scene);
        EXPECT_TRUE(collision_times(run).empty()) << engine << ' ' << part << ' ' << step;
        for (const Frame& frame : run.frames)
          ASSERT_NEAR(frame.poses[1].com_world.z(),
                      0.1 + amplitude * std::sin(frequency * frame.time), 1e-10)
              << engine << ' ' << part << ' ' << step << " at " << frame.time;
      }
    }
}

// Boxes on floors that rise and shake. Engines part by what a step leaves; timewarp is the ordered
// reference to the last bit.
TEST(DrivenBodies, AllEnginesMeetAsStepsGoToZero) {
  scene::BodySpec plate = box("plate", {0.22, 0.35, 0.01}, 0.06, {0, 0, 0.6}, {0.1, 0, 0});
  plate.world_from_body = Quaterniond(Eigen::AngleAxisd(0.2, Vector3d(1, 2, 0).normalized()));
  for (const auto& floor :
       {driven_plane("floor", {0, 0, 0.3}), driven_plane("floor", {0.2, 0, 0}, {0, 0, 0.03}, 10.0)})
    for (const double friction : {0.0, 0.5}) {
      // some impacts after the first; then it rattles, and parts
      scene::Scene scene = with_contact({floor, plate}, 0.36, friction, 0.5);
      double apart[2];
      for (int k = 0; k < 2; ++k) {
        scene.step_s = 1.0 / (240 << (2 * k));
        const Trajectory ordered = run_in("ordered", scene), rd = run_in("rd", scene);
        EXPECT_EQ(difference(ordered, run_in("tw", scene)), "");
        EXPECT_EQ(difference(ordered, run_in("ca", scene)), "");
        apart[k] =
            (ordered.frames.back().poses[1].com_world - rd.frames.back().poses[1].com_world).norm();
      }
      EXPECT_LT(apart[0], 1e-6) << friction;  // m: turning by RK4 against turning in closed form
      EXPECT_LT(apart[1], 0.1 * apart[0] + 1e-9) << friction;
    }
}

// A floor that is shaken once a step stands still at the ends of steps, but a box with friction
// does not move as on a floor at rest. Steps of a tenth of a radian need no word; nor do impacts of
// what flies freely, which are found at any instant.
TEST(DrivenBodies, FasterThanStepsFollowAreReportedInEveryEngine) {
  const double frequency = 2 * M_PI * 60.0;
  const auto shaken = [&](double step, double amplitude) {
    scene::Scene scene =
        with_contact({driven_plane("floor", Vector3d::Zero(), {amplitude, 0, 0}, frequency),
                      box("box", {0.1, 0.1, 0.05}, 1.0, {0, 0, 0.05}, {0, 1, 0})},
                     0.1, 0.3, 0.0);
    scene.step_s = step;
    return scene;
  };
  const auto says = [](const Trajectory& run) {
    for (const std::string& notice : run.counters.notices)
      if (notice.find("of the motion of 'floor'") != std::string::npos) return true;
    return false;
  };
  for (const char* engine : {"rd", "ca", "tw", "ordered"}) {
    SCOPED_TRACE(engine);
    EXPECT_TRUE(says(run_in(engine, shaken(1.0 / 60, 0.01))));
    EXPECT_FALSE(says(run_in(engine, shaken(0.1 / frequency, 0.01))));
    EXPECT_FALSE(says(run_in(engine, shaken(1.0 / 60, 0.0))));
    scene::Scene flies = shaken(1.0 / 60, 0.01);
    flies.contact.reset();
    flies.bodies[1].restitution = 1.0;
    flies.bodies[1].position_m.z() = 1.0;
    EXPECT_FALSE(says(run_in(engine, flies)));
    flies.effects.of<effects::RodSpec>().push_back(
        {"rod", {"floor", Vector3d::Zero()}, {"box", Vector3d::Zero()}, 1.0});
    flies.stabilisation = scene::StabilisationSpec{};
    EXPECT_TRUE(says(run_in(engine, flies)));
  }
}

}  // namespace
}  // namespace tumble::testing
