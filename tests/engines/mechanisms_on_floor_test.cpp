// Plane mechanisms that lie on a floor without friction: they move as they do without floor and
// gravity. Drawn by lot: chains and rings of bars, thrown as one body that turns, with hinges,
// welds and balls, a motor, a spring, drag.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/spring/spring.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_runs.h"

namespace tumble::testing {
namespace mechanisms_on_floor_test {

using effects::JointKind;

constexpr double kHalfHigh = 0.04;  // m

/// Bars between these corners, linked in a row; without floor and gravity.
/// @param closes  the last corner is the first
scene::Scene bars_between(const std::vector<Vector3d>& corners, bool closes, double speed,
                          double omega, Random& random) {
  std::vector<scene::BodySpec> bars;
  const std::size_t count = closes ? corners.size() : corners.size() - 1;
  std::vector<std::pair<std::string, std::string>> apart;
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3d &from = corners[k], &to = corners[(k + 1) % corners.size()];
    const Vector3d middle = 0.5 * (from + to), way = to - from;
    scene::BodySpec bar = box(
        fmt::format("bar {}", k), {0.45 * way.norm(), random.between(0.02, 0.06), kHalfHigh},
        std::pow(10.0, random.between(-0.5, 0.5)), middle,
        Vector3d(speed, 0, 0) + Vector3d(0, 0, omega).cross(middle - Vector3d(0, 0, kHalfHigh)));
    bar.omega_world_rad_s = {0, 0, omega};
    bar.world_from_body = Eigen::AngleAxisd(std::atan2(way.y(), way.x()), Vector3d::UnitZ());
    bar.restitution = 0.0;
    bars.push_back(bar);
    for (std::size_t j = 0; j < k; ++j) apart.emplace_back(bars[j].name, bar.name);
  }
  scene::Scene scene = scene_of(std::move(bars), 1.0);
  scene.stabilisation = scene::StabilisationSpec{};
  scene.apart = apart;
  return scene;
}

void join(scene::Scene& scene, JointKind kind, std::size_t a, std::size_t b, const Vector3d& at) {
  auto& joints = scene.effects.of<effects::JointSpec>();
  joints.push_back({fmt::format("joint {}", joints.size()), kind, scene.bodies[a].name,
                    scene.bodies[b].name, at, Vector3d::UnitZ()});
}

scene::Scene drawn_mechanism(Random& random) {
  const std::size_t bars = 2 + random.below(5);
  const bool closes = bars > 2 && random.below(2) == 0;
  std::vector<Vector3d> corners{{0, 0, kHalfHigh}};
  double direction = random.between(-3, 3);
  for (std::size_t k = 0; k < bars && !closes; ++k) {
    direction += random.between(-1, 1);
    corners.push_back(corners.back() + random.between(0.3, 0.8) *
                                           Vector3d(std::cos(direction), std::sin(direction), 0));
  }
  if (closes) corners.clear();
  for (std::size_t k = 0; k < bars && closes; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(bars);
    corners.emplace_back(random.between(0.4, 0.6) * std::cos(angle), 0.5 * std::sin(angle),
                         kHalfHigh);
  }
  scene::Scene scene =
      bars_between(corners, closes, random.between(-1, 1), random.between(-3, 3), random);
  for (std::size_t k = 1; k < bars; ++k)
    join(scene, random.below(5) == 0 ? JointKind::kWeld : JointKind::kHinge, k - 1, k, corners[k]);
  if (closes)
    join(scene, random.below(2) == 0 ? JointKind::kBall : JointKind::kHinge, bars - 1, 0,
         corners[0]);
  const effects::JointSpec& first = scene.effects.of<effects::JointSpec>().front();
  // it looks at instants of the grid, and others a rounding beside them
  if (first.kind == JointKind::kHinge && random.below(2) == 0)
    scene.effects.of<effects::MotorSpec>().push_back({.joint = first.name,
                                                      .offset_rad = 0.3,
                                                      .stiffness_n_m_rad = 0.3,
                                                      .damping_n_m_s_rad = 0.02});
  if (random.below(2) == 0)
    scene.effects.of<effects::SpringSpec>().push_back(
        {"spring", {"bar 0", Vector3d::Zero()}, {"", {1.5, 1, kHalfHigh}}, 20.0, 0.2, 0.5});
  if (random.below(2) == 0) scene.effects.of<effects::DragSpec>().push_back({"bar 1", 0.5, 0.05});
  return scene;
}

scene::Scene laid_on_a_floor(scene::Scene scene) {
  scene.bodies.push_back(plane("floor", {0, 0, 0}, {0, 0, 1}));
  scene.bodies.back().restitution = 0.0;
  scene.contact.emplace();
  effects::set_gravity(scene, kEarth);
  return scene;
}

/// A faint force straight down from shortly after 0.5 s on: a step of 1e-8 s ends there.
void press_soon_after_the_grid(scene::Scene& scene) {
  const scene::BodySpec& bar = scene.bodies.front();
  scene.effects.of<effects::PointForceSpec>().push_back(
      {bar.name, {0, 0, -1e-5}, bar.position_m, 0.5 + 1e-8, 0.1});
}

double farthest_apart(const Trajectory& one, const Trajectory& other, std::size_t bodies) {
  double farthest = 0.0;
  for (std::size_t i = 0; i < bodies; ++i)
    farthest = std::max(
        farthest,
        (one.frames.back().poses[i].com_world - other.frames.back().poses[i].com_world).norm());
  return farthest;
}

// What the floor presses with goes through all joints, and none of it may show in the plane: there a
// step leaves what RK4 leaves of it, or less where contacts shorten it because it turns far.
TEST(MechanismsOnAFloor, MoveAsWithoutFloorAndGravity) {
  // m: margins of contacts lift bars by 1e-10 of their size; what solvers leave of velocities,
  // 1e-8 of some m/s, is without effect in the plane
  constexpr double kLifted = 1e-9;
  Random random(5);
  for (int round = 0; round < 24; ++round) {
    scene::Scene scene = drawn_mechanism(random), fine = scene;
    scene.step_s = round % 2 == 0 ? 1.0 / 60 : 1.0 / 240;
    fine.step_s = scene.step_s / 16;
    const std::size_t bars = scene.bodies.size();
    const Trajectory truth = run_on("rd", fine);
    const double of_method = farthest_apart(run_on("rd", scene), truth, bars);
    for (const char* engine : {"rd", "tw"}) {
      SCOPED_TRACE(fmt::format("round {}, {}", round, engine));
      scene::Scene laid = laid_on_a_floor(scene);
      if (round % 3 == 0) press_soon_after_the_grid(laid);
      const Trajectory run = run_on(engine, laid);
      EXPECT_EQ(run.stopped_by, "");
      EXPECT_EQ(faults_of(run), "");
      EXPECT_LT(farthest_apart(run, truth, bars), 1.1 * of_method + kLifted);
    }
  }
}

/// Two bars of a kilogram in a row along x, from the origin, the first hinged to the world.
scene::Scene arm_on_a_floor(double omega, Random& random) {
  scene::Scene scene = bars_between({{0, 0, kHalfHigh}, {0.4, 0, kHalfHigh}, {0.8, 0, kHalfHigh}},
                                    false, 0.0, omega, random);
  join(scene, JointKind::kHinge, 0, 1, {0.4, 0, kHalfHigh});
  scene.effects.of<effects::JointSpec>().push_back(
      {"pivot", JointKind::kHinge, "bar 0", "", {0, 0, kHalfHigh}, Vector3d::UnitZ()});
  return laid_on_a_floor(std::move(scene));
}

// 0.7 s of the grid and 70 looks of 0.01 s differ by a rounding: one step ends there, and no second
// one of 1e-16 s follows, of which impulses over time would say what presses the bars.
TEST(MechanismsOnAFloor, AMotorThatLooksOnTheGridAsksForNoSteps) {
  Random random(1);
  scene::Scene scene = arm_on_a_floor(0.5, random);
  scene.duration_s = 1.0;
  scene.step_s = 1.0 / 60;
  scene.effects.of<effects::MotorSpec>().push_back(
      {.joint = "joint 0", .stiffness_n_m_rad = 0.1, .period_s = 0.01});
  // 60 on the grid, 100 looks, 20 of which are on both
  EXPECT_EQ(run_on("rd", scene).counters.counts.at("steps"), 140u);
}

// The hinges carry two bars and the end of a third, which lies on the floor with the rest of its
// weight. Of the two no pressure would move them: any would do, and what a solver made of it by
// rounding went to thousands of their weight.
TEST(MechanismsOnAFloor, WhatHingesHoldPressesNoFloor) {
  Random random(1);
  scene::Scene scene = bars_between(
      {{0, 0, kHalfHigh}, {0.4, 0, kHalfHigh}, {0.8, 0, kHalfHigh}, {1.2, 0, kHalfHigh}}, false,
      0.0, 2.0, random);
  join(scene, JointKind::kHinge, 0, 1, {0.4, 0, kHalfHigh});
  join(scene, JointKind::kBall, 1, 2, {0.8, 0, kHalfHigh});
  scene.effects.of<effects::JointSpec>().push_back(
      {"pivot", JointKind::kHinge, "bar 0", "", {0, 0, kHalfHigh}, Vector3d::UnitZ()});
  scene = laid_on_a_floor(std::move(scene));
  scene.step_s = 1.0 / 240;
  for (const char* engine : {"rd", "tw"}) {
    SCOPED_TRACE(engine);
    const Trajectory run = run_on(engine, scene);
    EXPECT_EQ(run.stopped_by, "");
    EXPECT_EQ(faults_of(run), "");
    for (const Frame& frame : run.frames)
      for (const ContactPoint& point : frame.contacts) {
        EXPECT_EQ(scene.bodies[static_cast<std::size_t>(point.body_a)].name, "bar 2");
        EXPECT_LT(point.force_on_a_world.norm(), *scene.bodies[2].mass_kg * kEarth.norm());
      }
  }
}

/// Bars of a kilogram in a row, along x or at a heading [rad], with friction, that turn together;
/// hinges link them and hold the first, but one, else the last, hangs on a ball.
scene::Scene arm_with_friction(std::size_t bars, double omega, double friction, Random& random,
                               std::optional<std::size_t> on_ball = {}, double heading = 0.0) {
  const auto kind_of = [&](std::size_t bar) {
    return bar == on_ball.value_or(bars - 1) ? JointKind::kBall : JointKind::kHinge;
  };
  std::vector<Vector3d> corners;
  for (std::size_t k = 0; k <= bars; ++k)
    corners.emplace_back(0.4 * static_cast<double>(k) * std::cos(heading),
                         0.4 * static_cast<double>(k) * std::sin(heading), kHalfHigh);
  scene::Scene scene = bars_between(corners, false, 0.0, omega, random);
  for (std::size_t k = 1; k < bars; ++k) join(scene, kind_of(k), k - 1, k, corners[k]);
  scene.effects.of<effects::JointSpec>().push_back(
      {"pivot", kind_of(0), "bar 0", "", corners[0], Vector3d::UnitZ()});
  for (scene::BodySpec& bar : scene.bodies) {
    bar.mass_kg = 1.0;
    bar.friction = friction;
  }
  scene = laid_on_a_floor(std::move(scene));
  scene.bodies.back().friction = friction;
  return scene;
}

/// By how much a bar slows a second that turns about a ball joint and slides on its four corners:
/// impulses p_i of least norm that balance its weight and friction mu p_i (-y_i, x_i) / r_i about
/// the joint, which stands `high` above the floor. [rad/s^2]
double slowing_by_even_spread(const Vector3d& half, double from_joint, double high, double mu) {
  std::vector<Vector2d> corners;
  for (const double x : {from_joint - half.x(), from_joint + half.x()})
    for (const double y : {-half.y(), half.y()}) corners.emplace_back(x, y);
  Eigen::Matrix<double, 2, 4> moments;  // of a unit of p_i, about y and x
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Vector2d& at = corners[static_cast<std::size_t>(i)];
    moments.col(i) << at.x() + high * mu * at.y() / at.norm(),
        at.y() - high * mu * at.x() / at.norm();
  }
  const Eigen::Vector4d forces = moments.transpose() * (moments * moments.transpose()).inverse() *
                                 Vector2d(from_joint * kEarth.norm(), 0);
  EXPECT_GT(forces.minCoeff(), 0.0);  // or least norm would ask for another support
  double torque = 0.0;
  for (Eigen::Index i = 0; i < 4; ++i)
    torque += mu * forces[i] * corners[static_cast<std::size_t>(i)].norm();
  const double inertia = (half.x() * half.x() + half.y() * half.y()) / 3 + from_joint * from_joint;
  return torque / inertia;
}

// A corner near the joint may carry what a far one does, on a lever of a fifth: statics does not
// tell, friction does. Impulses of least norm are the closed form; all on the near corners would
// slow the bar by half as much again.
TEST(MechanismsOnAFloor, ABarOnABallJointSlidesOnAllItsCorners) {
  constexpr double kOmega = 3.0, kFriction = 0.3, kFromJoint = 0.28, kHigh = 0.01;
  const Vector3d half(0.18, 0.05, kHigh);
  scene::BodySpec bar = box("bar", half, 1.0, {kFromJoint, 0, kHigh}, {0, kOmega * kFromJoint, 0});
  bar.omega_world_rad_s = {0, 0, kOmega};
  bar.restitution = 0.0;
  bar.friction = kFriction;
  scene::Scene scene = scene_of({bar}, 0.1);
  scene.effects.of<effects::JointSpec>().push_back(
      {"pivot", JointKind::kBall, "bar", "", {0, 0, kHigh}, Vector3d::UnitZ()});
  scene = laid_on_a_floor(std::move(scene));
  scene.bodies.back().friction = kFriction;
  const double slowed = 0.1 * slowing_by_even_spread(half, kFromJoint, kHigh, kFriction);
  for (const char* engine : {"rd", "tw"})
    for (const double steps : {60.0, 240.0, 960.0}) {
      SCOPED_TRACE(fmt::format("{}, {} steps a second", engine, steps));
      scene.step_s = 1 / steps;
      const Trajectory run = run_on(engine, scene);
      EXPECT_EQ(run.stopped_by, "");
      EXPECT_EQ(faults_of(run), "");
      // second order in the step: 2.6e-3 of what it slows by at 1/60 s (seen), and 1e-4 for events
      // near the start, which are no part of that
      EXPECT_NEAR(kOmega - run.frames.back().poses[0].omega_world.z(), slowed,
                  slowed * (1e-4 + 10 / (steps * steps)));
    }
}

bool says_undecided(const Trajectory& run) {
  return std::any_of(
      run.counters.notices.begin(), run.counters.notices.end(),
      [](const std::string& notice) { return notice.find("is not decided") != std::string::npos; });
}

// By lot, also narrow ones on rough floors, near tipping: what links leave open must not hang on the
// step, nor on errors of 1e-9 m. Corners near the ball, on a lever of 0.02 m, would slow the arm
// twenty times as fast.
TEST(MechanismsOnAFloor, ArmsWithFrictionSlowAlikeInAllSteps) {
  // of the energy at the start: what events of a grid differ by, of first order in the step
  constexpr double kAlike = 0.005;
  Random random(2);
  for (int round = 0; round < 12; ++round) {
    const bool narrow = round >= 6;
    const std::size_t bars = narrow ? 2 : 2 + random.below(2);
    const double omega = narrow ? random.between(1, 2) : random.between(1, 4),
                 friction = narrow ? random.between(0.7, 0.85) : random.between(0.1, 0.6);
    scene::Scene scene =
        arm_with_friction(bars, omega, friction, random, {}, narrow ? random.between(-3, 3) : 0.0);
    scene.duration_s = 0.2;
    if (narrow)
      for (std::size_t k = 0; k < bars; ++k)
        std::get<scene::BoxSpec>(scene.bodies[k].shape).half_extents_m = {
            0.16, random.between(0.042, 0.05), kHalfHigh};
    const char* engine = round % 3 == 2 ? "tw" : "rd";
    std::vector<double> left;
    for (const double steps : {480.0, 120.0, 60.0}) {
      SCOPED_TRACE(fmt::format("round {}, {}, {} steps a second", round, engine, steps));
      scene.step_s = 1 / steps;
      const Trajectory run = run_on(engine, scene);
      EXPECT_EQ(run.stopped_by, "");
      EXPECT_EQ(faults_of(run), "");
      left.push_back(run.frames.back().kinetic_energy / run.frames.front().kinetic_energy);
      EXPECT_NEAR(left.back(), left.front(), kAlike);
      EXPECT_FALSE(says_undecided(run));
    }
  }
}

// A ball in front of three bars that turn fast: at long steps no even load is found among several,
// and the motion parts from that of short ones, by 0.2 of the energy (seen).
TEST(MechanismsOnAFloor, WhereNothingTellsWhatCarriesIsSaid) {
  Random random(1);
  scene::Scene scene = arm_with_friction(4, 6.0, 0.8, random, 0);
  scene.duration_s = 0.3;
  scene.step_s = 1.0 / 60;
  for (const char* engine : {"rd", "tw"})
    EXPECT_TRUE(says_undecided(run_on(engine, scene))) << engine;
}

}  // namespace mechanisms_on_floor_test
}  // namespace tumble::testing
