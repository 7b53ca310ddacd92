// Boxes that land: flat, where all corners of a face meet the floor at one instant and what is
// symmetric stays so, or turning, corner by corner.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "tests/engines/reference_runs.h"

namespace tumble::testing::flat_landings_test {
namespace {

constexpr double kFall = 0.4, kEarth = 9.81;  // m, m/s^2

scene::Scene lands(const Vector3d& half, double restitution, double friction,
                   const Vector3d& velocity, double duration = 1.0) {
  scene::Scene scene = scene_of({box("box", half, 1.0, {0, 0, half.z() + kFall}, velocity),
                                 plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                                duration, Vector3d(0, 0, -kEarth));
  for (scene::BodySpec& body : scene.bodies) {
    body.restitution = restitution;
    body.friction = friction;
  }
  scene.contact.emplace();
  return scene;
}

// It slides along x; nothing moves it to the side, nothing turns it but about y.
void expect_symmetric(const Trajectory& run, double allowed) {
  EXPECT_EQ(run.stopped_by, "");
  for (const Frame& frame : run.frames) {
    const BodyPose& pose = frame.poses[0];
    ASSERT_NEAR(pose.com_world.y(), 0.0, allowed) << frame.time;
    ASSERT_NEAR(pose.omega_world.x(), 0.0, allowed) << frame.time;
    ASSERT_NEAR(pose.omega_world.z(), 0.0, allowed) << frame.time;
  }
}

// Without rebound, and flat enough for its corners to bear the friction of the landing (mu times
// the height of its centre is less than half its length), it stays flat: the landing takes
// mu v_n of its speed, the floor mu g a second of the rest.
TEST(FlatLandings, SlideOnAsTheirCornersBear) {
  const double fall_s = std::sqrt(2 * kFall / kEarth);
  Random random(3);
  for (int trial = 0; trial < 12; ++trial) {
    const Vector3d half(random.between(0.1, 0.2), random.between(0.05, 0.2),
                        random.between(0.05, 0.1));
    const double mu = random.between(0.1, 0.9), v = random.between(1.0, 5.0);
    const double after = v - mu * kEarth * fall_s;
    const double x = v * fall_s + (after > 0 ? after * after / (2 * mu * kEarth) : 0.0);
    for (const char* engine : {"rd", "ca", "tw"}) {
      SCOPED_TRACE(fmt::format("trial {}, {}", trial, engine));
      const Trajectory run = run_on(engine, lands(half, 0.0, mu, {v, 0, 0}, 6.0));
      expect_symmetric(run, 1e-9);  // what solvers leave of m/s
      EXPECT_NEAR(run.frames.back().poses[0].com_world.x(), x, 1e-6) << "margins, rounding";
    }
  }
}

// A box in contact whose far corners stand off by less than is seen: a ball that drops on its middle
// drives it into the floor at all corners, as if it lay flat. Struck at the near corners alone it
// would turn, and the far ones would lift these again, as a tall box does.
TEST(FlatLandings, WhatIsStruckInContactLiesOnAllItsCorners) {
  const Vector3d half(0.05, 0.05, 0.12);
  for (const double tilt : {1e-8, 1e-7, 5e-7}) {  // the far corners: up to 5e-8 m
    scene::Scene scene = lands(half, 0.0, 0.0, Vector3d::Zero(), 0.1);
    scene.bodies[0].position_m.z() = half.z() + half.x() * tilt;
    scene.bodies[0].world_from_body = Eigen::AngleAxisd(tilt, Vector3d::UnitY());
    // it meets the box before gravity has closed the corners
    scene.bodies.push_back(ball("ball", 0.05, 1.0, {0, 0, 2 * half.z() + 0.05 + 1e-6}, {0, 0, -2}));
    scene.bodies.back().restitution = 0.5;
    for (const char* engine : {"rd", "tw"}) {
      SCOPED_TRACE(fmt::format("tilt {}, {}", tilt, engine));
      const Trajectory run = run_on(engine, scene);
      EXPECT_EQ(run.stopped_by, "");
      for (const Frame& frame : run.frames)
        // the tilt closes within a step of 1/60 s: 3e-5 rad/s; by corners it is 0.6
        ASSERT_NEAR(frame.poses[0].omega_world.norm(), 0.0, 1e-4) << frame.time;
    }
  }
}

// With rebounds and on edges, where it may tumble: by lot, along x.
TEST(FlatLandings, StaySymmetric) {
  Random random(4);
  for (int trial = 0; trial < 40; ++trial) {
    const Vector3d half(random.between(0.05, 0.2), random.between(0.05, 0.2),
                        random.between(0.05, 0.2));
    const double e = random.below(3) == 0 ? 0.0 : random.between(0.1, 0.9),
                 mu = random.below(4) == 0 ? 0.0 : random.between(0.05, 1.0);
    scene::Scene scene = lands(half, e, mu, {random.between(0.5, 4.0), 0, 0}, 0.7);
    if (random.below(2) == 0)  // tilted about y: it lands on an edge
      scene.bodies[0].world_from_body =
          Eigen::AngleAxisd(random.between(-0.3, 0.3), Vector3d::UnitY());
    if (random.below(2) == 0) scene.bodies[0].omega_world_rad_s.y() = random.between(-3, 3);
    scene.bodies[0].position_m.z() += 0.2;
    const char* engine = trial % 2 == 0 ? "rd" : "tw";
    SCOPED_TRACE(fmt::format("trial {}, {}: e {}, mu {}", trial, engine, e, mu));
    // rounding, which tumbling makes some thousand times larger
    expect_symmetric(run_on(engine, scene), 1e-8);
  }
}

// It lands on a step beneath most of it: the middle of where they touch is struck, which turns it,
// and then both corners at the step's edge, which still approach, alike.
TEST(FlatLandings, OnAStepTipOverItsEdge) {
  for (const double e : {0.05, 0.1, 0.2})
    for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
      SCOPED_TRACE(fmt::format("e {}, {}", e, engine));
      scene::Scene scene = lands({0.2, 0.1, 0.1}, e, 0.0, Vector3d::Zero(), 0.4);
      scene.bodies[0].position_m.z() += 0.2;
      scene.bodies.push_back(box("step", {0.5, 0.5, 0.1}, 1.0, {0.35, 0, 0.1}, Vector3d::Zero()));
      scene.bodies.back().immovable = true;
      scene.bodies.back().mass_kg.reset();
      scene.bodies.back().restitution = e;
      expect_symmetric(run_on(engine, scene), 1e-10);
    }
}

// On a smooth floor all forces are vertical: nothing changes the angular momentum about the vertical
// of a plate that spins down, corner by corner, from one step's contacts to the next one's.
TEST(SpinningDown, OnASmoothFloorKeepsTheSpinAboutTheVertical) {
  Random random(8);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3d half(random.between(0.05, 0.15), random.between(0.05, 0.15),
                        random.between(0.005, 0.03));
    scene::Scene scene = scene_of({box("plate", half, 1.0, {0, 0, half.norm()}, Vector3d::Zero()),
                                   plane("floor", Vector3d::Zero(), Vector3d::UnitZ())},
                                  1.0, Vector3d(0, 0, -9.81));
    scene.bodies[0].world_from_body =
        Eigen::AngleAxisd(random.between(0.1, 1.0), Vector3d::UnitY()) *
        Eigen::AngleAxisd(random.between(0.0, 1.0), Vector3d::UnitX());
    scene.bodies[0].omega_world_rad_s = {0, 0, random.between(5, 20)};
    for (scene::BodySpec& body : scene.bodies) body.restitution = 0.0;
    scene.contact.emplace();
    const char* engine = trial % 2 == 0 ? "rd" : "tw";
    SCOPED_TRACE(fmt::format("trial {}, {}", trial, engine));
    const Trajectory run = run_on(engine, scene);
    EXPECT_EQ(run.stopped_by, "");
    const double spin = run.frames.front().angular_momentum_world.z();
    for (const Frame& frame : run.frames)
      ASSERT_NEAR(frame.angular_momentum_world.z(), spin, 1e-11 * std::abs(spin)) << "rounding";
  }
}

// A box that rebounds flat goes on flat: pushed beside the line through its centre of mass by what
// rounding leaves, it was turned thirty times as far by each bounce, and tumbled after six.
TEST(FlatRebounds, DoNotTurn) {
  scene::Scene falls = lands({0.15, 0.1, 0.05}, 0.9, 0.0, Vector3d::Zero(), 6.0);
  falls.bodies[0].world_from_body = Eigen::AngleAxisd(0.3, Vector3d::UnitZ());
  scene::Scene falls_on_box = falls;
  falls_on_box.bodies[1] = box("floor", {2, 2, 0.5}, 1.0, {0.1, 0.2, -0.5}, Vector3d::Zero());
  falls_on_box.bodies[1].immovable = true;
  falls_on_box.bodies[1].mass_kg.reset();
  falls_on_box.bodies[1].restitution = 0.9;
  scene::Scene between = scene_of({plane("left", {-0.5, 0, 0}, Vector3d::UnitX()),
                                   plane("right", {0.5, 0, 0}, -Vector3d::UnitX()),
                                   box("box", {0.1, 0.1, 0.1}, 1.0, Vector3d::Zero(), {3, 0, 0})},
                                  6.0);
  for (const scene::Scene& scene : {falls, falls_on_box, between})
    for (const char* engine : {"rd", "ca", "tw"}) {
      SCOPED_TRACE(fmt::format("{} bodies, {}", scene.bodies.size(), engine));
      const Trajectory run = run_on(engine, scene);
      EXPECT_EQ(run.stopped_by, "");
      for (const Frame& frame : run.frames)
        for (const BodyPose& pose : frame.poses)
          ASSERT_LT(pose.omega_world.norm(), 1e-11) << frame.time << ": rounding";
    }
}

// A box 100 times as heavy drives a light one against a wall: they collide 31 times, as the digits
// of pi say (G. Galperin, Playing pool with pi, 2003).
TEST(FlatRebounds, OfALightBoxBetweenAWallAndAHeavyOneCountPi) {
  const scene::Scene scene =
      scene_of({plane("wall", Vector3d::Zero(), Vector3d::UnitX()),
                box("light", {0.1, 0.1, 0.1}, 1.0, {1, 0, 0}, Vector3d::Zero()),
                box("heavy", {0.1, 0.1, 0.1}, 100.0, {2, 0, 0}, {-1, 0, 0})},
               4.0);
  for (const char* engine : {"rd", "ca", "tw"})
    EXPECT_EQ(collision_times(run_on(engine, scene)).size(), 31u) << engine;
}

}  // namespace
}  // namespace tumble::testing::flat_landings_test
