// A ball that slides or rolls on a ball follows its curve, and leaves it where the normal force
// reaches zero.
//
// A point of mass m slides from rest at cos c0 without friction: v^2 = 2 g R (c0 - c), and N = m (g
// c - v^2 / R) = 0 at c = 2/3 c0. A ball that rolls has 7/10 m v^2: v^2 = 10/7 g R (c0 - c), and
// leaves at c = 10/17 c0. R is the distance of the centres.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/engines/timewarp/fast_timewarp.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

struct Dome {
  double radius = 1.0, ball = 0.05, friction = 0.0;
  double start_cosine = 0.99862953475457387;  // 3 degrees off the top
  Vector3d velocity = Vector3d::Zero();       // of both [m/s]
};

Trajectory run_dome(const Dome& dome, double step_s, const std::string& engine) {
  static const Laws laws = reference_laws();
  const double R = dome.radius + dome.ball,
               sine = std::sqrt(1 - dome.start_cosine * dome.start_cosine);
  scene::BodySpec below = ball("dome", dome.radius, 1.0, Vector3d::Zero(), Vector3d::Zero());
  below.mass_kg.reset();
  below.immovable = true;
  scene::BodySpec rider =
      ball("ball", dome.ball, 1.0, R * Vector3d(sine, 0, dome.start_cosine), Vector3d::Zero());
  rider.restitution = 0.0;
  if (!dome.velocity.isZero(0.0)) below.motion = scene::PrescribedMotion{dome.velocity};
  rider.velocity_m_s = dome.velocity;
  below.friction = rider.friction = dome.friction;
  scene::Scene scene = scene_of(
      {below, rider}, 1.45 * std::sqrt(R / 1.05) * (dome.friction > 0 ? 1.2 : 1.0), kEarth);
  scene.contact = scene::ContactSpec{};
  scene.step_s = step_s;
  engines::RunOptions options;
  options.engine = engine;
  options.frame_rate_hz = 240.0;
  return run_as_told(std::move(options), scene, laws);
}

int collisions_of(const Trajectory& run) {
  return static_cast<int>(
      std::count_if(run.events.begin(), run.events.end(),
                    [](const Event& event) { return event.kind == EventKind::kCollision; }));
}

/// Of the normal at the instant at which the contact ends.
double cosine_where_it_leaves(const Trajectory& run) {
  for (const Event& event : run.events)
    if (event.kind == EventKind::kBreak)
      return event.normal_b_to_a_world.z() * (event.body_a == 1 ? 1.0 : -1.0);
  return kUnset;
}

/// |v|^2 / 2 + g z is kept by what only pushes at right angles, or rolls.
double energy_change(const Trajectory& run) {
  const auto energy = [](const Frame& frame) {
    return frame.kinetic_energy + frame.potential_energy;
  };
  double most = 0.0;
  for (const Frame& frame : run.frames)
    most = std::max(most, std::abs(energy(frame) - energy(run.frames.front())));
  return most / 9.81;  // of m g times a metre
}

TEST(Dome, ABallThatSlidesLeavesWhereTheForceEndsAndStrikesNothingOnItsWay) {
  const double truth = 2.0 / 3.0 * 0.99862953475457387;
  for (const std::string engine : {"rd", "ordered", "ca", "tw"}) {
    double before = kUnset;
    for (const double step : {1.0 / 60, 1.0 / 240, 1.0 / 960}) {
      const Trajectory run = run_dome({}, step, engine);
      EXPECT_EQ(run.stopped_by, "") << engine;
      EXPECT_EQ(collisions_of(run), 0) << engine << " at " << step;
      const double error = std::abs(cosine_where_it_leaves(run) - truth);
      // The step in which the force ends still has some, and one or two pass until the gap, which
      // grows as t^3, shows: the angle goes by v h / R = 2.5 rad/s h in each, its cosine by 0.75 of
      // that.
      EXPECT_LT(error, 5.0 * step) << engine << " at " << step;
      if (!std::isnan(before)) {
        EXPECT_LT(error, 0.6 * before) << engine << " at " << step << ": first order at least";
      }
      before = error;
      EXPECT_LT(energy_change(run), 2.0 * step * step) << engine << " at " << step;
      // which takes back what the path between the ends of steps dips; frames of the others within
      // a step do not yet
      if (engine == "rd") {
        for (const Frame& frame : run.frames) ASSERT_GE(frame.smallest_gap, 0.0) << engine;
      }
    }
  }
}

TEST(Dome, ABallThatRollsLeavesLater) {
  const double truth = 10.0 / 17.0 * 0.99862953475457387;
  for (const std::string engine : {"rd", "ordered"})
    for (const double step : {1.0 / 240, 1.0 / 960}) {
      const Trajectory run = run_dome({.friction = 1000.0}, step, engine);
      EXPECT_EQ(collisions_of(run), 0) << engine << " at " << step;
      EXPECT_NEAR(cosine_where_it_leaves(run), truth, 5.0 * step) << engine << " at " << step;
    }
}

TEST(Dome, SizesDoNotMatter) {
  for (const double size : {1e-2, 1.0, 50.0})
    for (const double part : {0.01, 0.3, 2.0}) {
      const Trajectory run = run_dome({size, part * size, 0.0}, std::sqrt(size) / 480, "rd");
      EXPECT_EQ(collisions_of(run), 0) << size << ", " << part;
      EXPECT_NEAR(cosine_where_it_leaves(run), 2.0 / 3.0 * 0.99862953475457387, 0.02)
          << size << ", " << part;
    }
}

TEST(Dome, ThatMovesSteadilyShowsTheSame) {
  for (const std::string engine : {"rd", "tw"}) {
    const Trajectory here = run_dome({}, 1.0 / 60, engine);
    for (const Vector3d& V : {Vector3d(3, 0, 0), Vector3d(-1, 2, 0), Vector3d(0, 0, 2)}) {
      const Trajectory there = run_dome({.velocity = V}, 1.0 / 60, engine);
      ASSERT_EQ(there.frames.size(), here.frames.size());
      for (std::size_t i = 0; i < here.frames.size(); ++i)
        ASSERT_LT((there.frames[i].poses[1].com_world - here.frames[i].time * V -
                   here.frames[i].poses[1].com_world)
                      .norm(),
                  1e-11)
            << engine << " V " << V.transpose() << " at " << here.frames[i].time;
    }
  }
}

// A ball that slides off a table turns about its edge, as on a dome of no radius: with v^2 = v0^2 +
// 2 g r (1 - c) it leaves at c = 2/3 + v0^2 / (3 g r).
TEST(Edge, ABallThatSlidesOverItLeavesWhereTheForceEnds) {
  static const Laws laws = reference_laws();
  const double r = 0.1, v0 = 0.3, truth = 2.0 / 3.0 + v0 * v0 / (3 * 9.81 * r);
  scene::BodySpec table = box("table", {1, 1, 0.5}, 1.0, {-1, 0, -0.5}, Vector3d::Zero());
  table.mass_kg.reset();
  table.immovable = true;
  scene::BodySpec rider = ball("ball", r, 1.0, {-0.1, 0, r}, {v0, 0, 0});
  rider.restitution = 0.0;
  scene::Scene scene = scene_of({table, rider}, 0.8, kEarth);
  scene.contact = scene::ContactSpec{};
  for (const std::string engine : {"rd", "ordered", "ca", "tw"})
    for (const double step : {1.0 / 60, 1.0 / 240, 1.0 / 960}) {
      scene.step_s = step;
      engines::RunOptions options;
      options.engine = engine;
      options.frame_rate_hz = 240.0;
      const Trajectory run = run_as_told(std::move(options), scene, laws);
      EXPECT_EQ(collisions_of(run), 0) << engine << " at " << step;
      // two steps late: the angle goes by v h / r = 8 rad/s h
      EXPECT_NEAR(cosine_where_it_leaves(run), truth, 12 * step) << engine << " at " << step;
      EXPECT_LT(energy_change(run), step * step) << engine << " at " << step;
    }
}

}  // namespace
}  // namespace tumble::testing
