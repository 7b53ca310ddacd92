// Bodies at rest fall asleep, keep their places to the last bit at no cost, and wake for whatever
// would move them.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/effects/drag/drag.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing::sleeping_test {
namespace {

constexpr double kG = 9.81;
const Vector3d kGravity(0, 0, -kG);

scene::BodySpec rough(scene::BodySpec body, double friction = 0.5) {
  body.friction = friction;
  body.restitution = 0.0;
  return body;
}

scene::BodySpec floor_body() { return rough(plane("floor", Vector3d::Zero(), Vector3d::UnitZ())); }

scene::Scene sleepy(std::vector<scene::BodySpec> bodies, double duration,
                    std::optional<Vector3d> gravity = kGravity) {
  scene::Scene scene = scene_of(std::move(bodies), duration, gravity);
  scene.contact.emplace();
  scene.contact->sleep = true;
  return scene;
}

/// Boxes of 1 m on top of each other, and the floor as last body.
scene::Scene stack_of(int n, double duration) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < n; ++i)
    bodies.push_back(rough(
        box("box " + std::to_string(i), {0.5, 0.5, 0.5}, 1.0, {0, 0, 0.5 + i}, Vector3d::Zero())));
  bodies.push_back(floor_body());
  return sleepy(bodies, duration);
}

scene::Scene block_on_floor(double duration) { return stack_of(1, duration); }

Trajectory run_it(const scene::Scene& scene) {
  const Trajectory result = run(scene, reference_laws());
  EXPECT_EQ(result.stopped_by, "");
  for (const Frame& frame : result.frames)
    EXPECT_GE(frame.smallest_gap, 0.0) << "t = " << frame.time;
  return result;
}

Trajectory run_awake(scene::Scene scene) {
  scene.contact->sleep = false;
  return run_it(scene);
}

std::vector<double> times_of(const Trajectory& run, EventKind kind, int body) {
  std::vector<double> times;
  for (const Event& event : run.events)
    if (event.kind == kind && event.body_a == body) times.push_back(event.time);
  return times;
}

bool falls_asleep(const Trajectory& run, int body) {
  return !times_of(run, EventKind::kSleep, body).empty();
}

bool same_bits(const BodyPose& a, const BodyPose& b) {
  return a.com_world == b.com_world && a.world_from_body.coeffs() == b.world_from_body.coeffs() &&
         a.velocity_world == b.velocity_world && a.omega_world == b.omega_world;
}

double farthest_apart(const Frame& a, const Frame& b) {
  double farthest = 0.0;
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    farthest = std::max(farthest, (a.poses[i].com_world - b.poses[i].com_world).norm());
  return farthest;
}

TEST(Sleeping, AStackKeepsItsPositionToTheLastBitAndStillReportsItsReactions) {
  const Trajectory result = run_it(stack_of(10, 3.0));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(times_of(result, EventKind::kSleep, i).size(), 1u) << i;
  const double asleep = times_of(result, EventKind::kSleep, 0).front();
  EXPECT_NEAR(asleep, 0.5, 0.1);
  const Frame& last = result.frames.back();
  for (const Frame& frame : result.frames)
    for (int i = 0; i < 10 && frame.time > asleep + 0.02; ++i)
      EXPECT_TRUE(same_bits(frame.poses[i], last.poses[i])) << frame.time << ' ' << i;
  const auto looked =
      std::find_if(result.frames.begin(), result.frames.end(),
                   [&](const Frame& frame) { return std::abs(frame.time - asleep) < 1e-9; });
  ASSERT_NE(looked, result.frames.end());  // the last frame that was looked at awake
  EXPECT_EQ(looked->smallest_gap, last.smallest_gap);
  double carried = 0.0;
  for (const ContactPoint& contact : last.contacts)
    if (contact.body_b == 10) carried += contact.force_on_a_world.z();
  EXPECT_NEAR(carried, 10 * kG, 1e-6 * 10 * kG);
  EXPECT_EQ(last.kinetic_energy, 0.0);
}

TEST(Sleeping, CostsNothing) {
  const auto counts = [](double duration) {
    return run_it(stack_of(10, duration)).counters.counts;
  };
  const auto a_while = counts(1.0), longer = counts(4.0);
  for (const char* counter : {"integrations", "derivative_evaluations", "gravity_calls",
                              "candidate_pairs", "gap_evaluations", "root_findings",
                              "contact_solves", "contact_points", "position_corrections"})
    EXPECT_EQ(a_while.at(counter), longer.at(counter)) << counter;
  // 3 s in steps of 1/60 s
  EXPECT_EQ(longer.at("body_steps_asleep") - a_while.at("body_steps_asleep"), 10u * 180u);
}

/// A ball that flies along x and meets the top box of a stack of three, which slides and does not
/// rock: what boxes that rock do depends on which corner comes down first, which no shell decides
/// twice alike.
scene::Scene stack_and_ball() {
  scene::Scene scene = stack_of(3, 4.0);
  scene.bodies.push_back(rough(ball("ball", 0.2, 0.2, {-2.0, 0, 2.5}, {2.0, 0, 0})));
  // along which it rolls: slowly enough for all to sleep before
  scene.bodies.push_back(rough(box("shelf", {4, 1, 0.1}, 1.0, {-4.6, 0, 2.2}, Vector3d::Zero())));
  scene.bodies.back().immovable = true;
  scene.bodies[4].position_m.x() = -3.0;
  for (int i = 0; i < 3; ++i) scene.bodies[i].friction = 0.05;
  return scene;
}

TEST(Sleeping, ABallWakesTheWholeStackAndAllGoesOnAsIfNothingHadSlept) {
  const scene::Scene scene = stack_and_ball();
  const Trajectory slept = run_it(scene), awake = run_awake(scene);
  for (int i = 0; i < 3; ++i) ASSERT_FALSE(times_of(slept, EventKind::kWake, i).empty()) << i;
  const double woken = times_of(slept, EventKind::kWake, 0).front();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(times_of(slept, EventKind::kWake, i).front(), woken) << i;
  // it was hit
  EXPECT_GT((awake.frames.back().poses[2].com_world - scene.bodies[2].position_m).norm(), 1e-3);
  // The rest tolerance of a stack (a creep of 1e-6 m); measured 2e-9 m, what shells of 1e-10 m make
  // of a hit.
  EXPECT_LT(farthest_apart(slept.frames.back(), awake.frames.back()), 1e-6);
}

TEST(Sleeping, APassingBodyWakesNoBody) {
  scene::Scene scene = block_on_floor(3.0);
  // 5 cm beside the block, at t = 1.3 s
  auto passer = ball("passer", 0.2, 1.0, {0.75, -4, 0.5}, {0, 3, 0});
  passer.collides = true;
  effects::set_gravity(scene, kGravity);
  passer.position_m.z() = 0.5;
  scene.bodies.push_back(passer);
  scene.bodies.push_back(
      rough(box("rail", {0.3, 6, 0.1}, 1.0, {0.85, 0, 0.2 - 1e-9}, Vector3d::Zero()), 0.0));
  scene.bodies.back().immovable = true;
  const Trajectory result = run_it(scene);
  EXPECT_TRUE(falls_asleep(result, 0));
  EXPECT_TRUE(times_of(result, EventKind::kWake, 0).empty());
}

// Gravity is so weak that the two are slow for seconds; nothing holds them.
TEST(Sleeping, NothingSleepsAtTheTopOfItsPath) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 2; ++i)
    bodies.push_back(rough(
        box("box " + std::to_string(i), {0.5, 0.5, 0.5}, 1.0, {0, 0, 5.0 + i}, {0, 0, 2e-6})));
  bodies.push_back(floor_body());
  const Trajectory result = run_it(sleepy(bodies, 4.0, Vector3d(0, 0, -1e-6)));
  EXPECT_FALSE(falls_asleep(result, 0));
}

scene::Scene creeping_block(double speed, double friction) {
  const double angle = 0.4;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle)),
      down(std::cos(angle), 0, -std::sin(angle));
  auto block = rough(box("block", {0.1, 0.1, 0.05}, 1.0, 0.05 * normal, speed * down),
                     friction * std::tan(angle));
  auto ramp = rough(plane("ramp", Vector3d::Zero(), normal), 1.0);
  block.world_from_body = ramp.world_from_body =
      Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  return sleepy({block, ramp}, 3.0);
}

// Slides by a micrometre a second, and ever faster by 4e-7 m/s^2: far below what counts as slow.
TEST(Sleeping, WhatTrulySlidesIsAwakeHoweverSlow) {
  EXPECT_FALSE(falls_asleep(run_it(creeping_block(1e-6, 1 - 1e-7)), 0));
  EXPECT_TRUE(falls_asleep(run_it(creeping_block(0.0, 1.1)), 0));
}

// A frictionless block on a slope of 1e-6 rad, from rest: in half a second it goes a micrometre, in
// 20 s 2 mm.
TEST(Sleeping, WhatAFaintSlopeSetsInMotionIsAwake) {
  const double angle = 1e-6, duration = 20.0;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  auto block = rough(box("block", {0.1, 0.1, 0.1}, 1.0, 0.1 * normal, Vector3d::Zero()), 0.0);
  auto slope = rough(plane("slope", Vector3d::Zero(), normal), 0.0);
  block.world_from_body = slope.world_from_body =
      Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  const Trajectory slept = run_it(sleepy({block, slope}, duration));
  EXPECT_FALSE(falls_asleep(slept, 0));
  // g sin(angle) t^2 / 2; contact shells are 1e-11 m
  EXPECT_NEAR(slept.frames.back().poses[0].com_world.x() - block.position_m.x(),
              0.5 * kG * angle * duration * duration, 1e-9);
}

/// A smooth box on a level floor, drawn by a spring whose damper lets it go slowly.
scene::Scene box_on_spring(double stiffness, double damping, double stretch, double duration) {
  scene::Scene scene = block_on_floor(duration);
  scene.bodies[0].friction = 0.0;
  scene.bodies[0].position_m.x() = 2.0 + stretch;
  effects::SpringSpec spring{"spring", {"", {0, 0, 0.5}}, {"box 0", Vector3d::Zero()}};
  spring.stiffness_n_m = stiffness;
  spring.damping_n_s_m = damping;
  spring.rest_length_m = 2.0;
  scene.effects.of<effects::SpringSpec>().push_back(spring);
  return scene;
}

// m x" + c x' + k x = 0 from rest, overdamped: x = x0 (b e^(-a t) - a e^(-b t)) / (b - a), with a b
// = k / m and a + b = c / m.
TEST(Sleeping, WhatCreepsAgainstADamperIsAwakeHoweverSlow) {
  const double k = 0.03, c = 30.0, x0 = 0.01, duration = 30.0;  // 1e-5 m/s
  const Trajectory result = run_it(box_on_spring(k, c, x0, duration));
  EXPECT_FALSE(falls_asleep(result, 0));
  const double root = std::sqrt(0.25 * c * c - k), b = 0.5 * c + root, a = k / b;
  const double x = x0 * (b * std::exp(-a * duration) - a * std::exp(-b * duration)) / (b - a);
  // the method's error in the first steps, c h = 1/2, is 1e-4 of x0 a / b = 3e-7 m; asleep, it would
  // be 3e-4 m off
  EXPECT_NEAR(result.frames.back().poses[0].com_world.x() - 2.0, x, 1e-8);
}

// Nearer to its place than 5 um it is let be; the damper has brought it there after 2.4 s or so.
TEST(Sleeping, WhatADamperHasBroughtToRestSleeps) {
  const Trajectory result = run_it(box_on_spring(40.0, 12.0, 0.01, 6.0));
  ASSERT_TRUE(falls_asleep(result, 0));
  EXPECT_LT(times_of(result, EventKind::kSleep, 0).front(), 4.0);
  EXPECT_NEAR(result.frames.back().poses[0].com_world.x(), 2.0, 5e-6);
}

// Friction holds 0.5 m g: the spring pulls with a tenth of it all along.
TEST(Sleeping, WhatFrictionHoldsAgainstASpringSleeps) {
  scene::Scene scene = box_on_spring(49.05, 1.0, 0.01, 2.0);
  scene.bodies[0].friction = 0.5;
  const Trajectory result = run_it(scene);
  ASSERT_TRUE(falls_asleep(result, 0));
  EXPECT_NEAR(times_of(result, EventKind::kSleep, 0).front(), 0.5, 0.1);
}

// Drag holds it to g sin(angle) m / c = 1e-6 m/s.
TEST(Sleeping, WhatSlidesThroughAThickMediumIsAwake) {
  const double angle = 1e-4, drag = 1e-4 * kG / 1e-6, duration = 10.0;
  scene::Scene scene = creeping_block(0.0, 0.0);
  scene.duration_s = duration;
  scene.step_s = 1e-3;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  for (scene::BodySpec& body : scene.bodies)
    body.world_from_body = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  scene.bodies[0].position_m = 0.05 * normal;
  scene.bodies[1].position_m = Vector3d::Zero();
  scene.effects.of<effects::DragSpec>().push_back({"block", drag, 0.0});
  const Trajectory result = run_it(scene);
  EXPECT_FALSE(falls_asleep(result, 0));
  // 1e-6 m/s but for its first 1/c = 1e-3 s; sin(angle) differs from it by 2e-9
  EXPECT_NEAR((result.frames.back().poses[0].com_world - scene.bodies[0].position_m).norm(),
              1e-6 * duration, 1e-8);
}

// I w' = k (angle0 - angle) - c w, with c / I = 3 / s and k / c = 1e-3 / s: 2e-5 rad/s.
TEST(Sleeping, ADoorThatAMotorClosesSlowlyIsAwake) {
  auto door = rough(box("door", {0.5, 0.02, 1.0}, 20.0, {0.5, 0, 1}, Vector3d::Zero()));
  scene::Scene scene = sleepy({door}, 30.0);
  scene.effects.of<effects::JointSpec>().push_back(
      {"hinge", effects::JointKind::kHinge, "door", "", {0, 0, 1}, Vector3d::UnitZ()});
  scene.stabilisation.emplace();
  effects::MotorSpec motor;
  motor.joint = "hinge";
  motor.offset_rad = 5e-3;
  motor.stiffness_n_m_rad = 0.02;
  motor.damping_n_m_s_rad = 20.0;
  scene.effects.of<effects::MotorSpec>().push_back(motor);
  const Trajectory slept = run_it(scene), awake = run_awake(scene);
  EXPECT_FALSE(falls_asleep(slept, 0));
  EXPECT_EQ(farthest_apart(slept.frames.back(), awake.frames.back()), 0.0);
  // a part of 1 - e^(-0.03) of half a metre times 5e-3 rad
  EXPECT_NEAR((awake.frames.back().poses[0].com_world - door.position_m).norm(), 7.4e-5, 1e-5);
}

// Two blocks, one on the other, that glide over a level floor by 5 um a second count as still. What
// sleep takes is told as what sleep takes: no step mends it.
TEST(Sleeping, WhatItTakesFromBodiesThatMoveIsToldWithTheRemedy) {
  scene::Scene scene = stack_of(2, 4.0);
  for (int i = 0; i < 2; ++i) {
    scene.bodies[i].friction = 0.0;
    scene.bodies[i].velocity_m_s = {5e-6, 0, 0};
  }
  const Trajectory slept = run_it(scene), awake = run_awake(scene);
  EXPECT_TRUE(awake.counters.faults.empty());
  ASSERT_TRUE(falls_asleep(slept, 0));
  ASSERT_FALSE(slept.counters.faults.empty());
  const RunFault& fault = slept.counters.faults[0];
  EXPECT_EQ(fault.kind, "energy_lost");
  EXPECT_NE(fault.meaning.find("falls asleep"), std::string::npos) << fault.meaning;
  EXPECT_NE(fault.remedy.find("\"sleep\": false"), std::string::npos) << fault.remedy;
  EXPECT_EQ(fault.remedy.find("a step of at most"), std::string::npos) << fault.remedy;
}

// A smooth block that glides, and a ball that rolls: slower than what counts as still in an island.
TEST(Sleeping, WhatGlidesOrRollsByItselfGoesOnHoweverSlow) {
  const double speed = 5e-6, duration = 4.0;
  scene::Scene gliding = block_on_floor(duration);
  gliding.bodies[0].friction = 0.0;
  gliding.bodies[0].velocity_m_s = {speed, 0, 0};
  scene::BodySpec wheel = rough(ball("ball", 0.5, 1.0, {0, 0, 0.5}, {speed, 0, 0}));
  wheel.omega_world_rad_s = {0, speed / 0.5, 0};
  for (const scene::Scene& scene : {gliding, sleepy({wheel, floor_body()}, duration)}) {
    const Trajectory result = run_it(scene);
    EXPECT_FALSE(falls_asleep(result, 0)) << scene.bodies[0].name;
    // contact shells of 1e-10 m tilt a block by no more than that of its size
    EXPECT_NEAR(result.frames.back().poses[0].com_world.x(), speed * duration, 1e-9)
        << scene.bodies[0].name;
  }
}

TEST(Sleeping, AForceThatIsSwitchedOnWakes) {
  scene::Scene scene = block_on_floor(4.0);
  scene.effects.of<effects::PointForceSpec>().push_back(
      {"box 0", {8, 0, 0}, {-0.5, 0, 0.5}, 1.5, 1.0});
  const Trajectory result = run_it(scene);
  ASSERT_EQ(times_of(result, EventKind::kWake, 0).size(), 1u);
  EXPECT_EQ(times_of(result, EventKind::kWake, 0).front(), 1.5);
  // a = (8 - 0.5 m g) / m for 1 s, then a' = 0.5 g until it stops; contact shells tilt nothing:
  // 1e-9 m.
  const double a = 8 - 0.5 * kG, braking = 0.5 * kG;
  EXPECT_NEAR(result.frames.back().poses[0].com_world.x(), 0.5 * a + 0.5 * a * a / braking, 1e-9);
  EXPECT_EQ(times_of(result, EventKind::kSleep, 0).size(), 2u);  // and sleeps again
}

// A smooth block on a slope, held by a hand that lets go.
TEST(Sleeping, AForceThatIsSwitchedOffWakes) {
  scene::Scene scene = creeping_block(0.0, 0.0);
  const double angle = 0.4;
  const Vector3d up(-std::cos(angle), 0, std::sin(angle));
  scene.effects.of<effects::PointForceSpec>().push_back(
      {"block", kG * std::sin(angle) * up, scene.bodies[0].position_m, 0.0, 2.0});
  const Trajectory result = run_it(scene);
  EXPECT_TRUE(falls_asleep(result, 0));
  EXPECT_EQ(times_of(result, EventKind::kWake, 0), std::vector<double>{2.0});
  EXPECT_NEAR((result.frames.back().poses[0].com_world - scene.bodies[0].position_m).norm(),
              0.5 * kG * std::sin(angle), 1e-9);
}

// A motor presses a bar on a stop for 2 s, then turns it away: at its largest torque all the while.
TEST(Sleeping, AControlLawThatChangesItsMindWakes) {
  auto bar = rough(box("bar", {0.5, 0.05, 0.05}, 1.0, {0.5, 0, 1}, Vector3d::Zero())),
       stop = rough(box("stop", {0.1, 0.1, 0.1}, 1.0, {0.9, 0, 0.85 - 1e-9}, Vector3d::Zero()));
  stop.immovable = true;
  scene::Scene scene = sleepy({bar, stop}, 2.5, std::nullopt);
  scene.effects.of<effects::JointSpec>().push_back(
      {"hinge", effects::JointKind::kHinge, "bar", "", {0, 0, 1}, Vector3d::UnitY()});
  scene.stabilisation.emplace();
  effects::MotorSpec motor;
  motor.joint = "hinge";
  motor.amplitude_rad = 100.0;
  motor.frequency_hz = 0.25;
  motor.phase_rad = 0.1;
  motor.stiffness_n_m_rad = 1e3;
  motor.largest_torque_n_m = 0.5;
  scene.effects.of<effects::MotorSpec>().push_back(motor);
  // which way a positive torque turns is not the test's business
  for (const double sign : {1.0, -1.0}) {
    scene.effects.of<effects::MotorSpec>()[0].amplitude_rad = sign * 100.0;
    const Trajectory result = run_it(scene);
    if (!falls_asleep(result, 0)) continue;
    ASSERT_EQ(times_of(result, EventKind::kWake, 0).size(), 1u);
    // the torque changes sign; it looks every 0.01 s
    EXPECT_NEAR(times_of(result, EventKind::kWake, 0).front(), 2.0 - 0.1 / (0.5 * 3.14159265),
                0.011);
    EXPECT_GT(std::abs(result.frames.back().poses[0].com_world.z() - 1.0), 0.01);
    return;
  }
  FAIL() << "it never slept on the stop";
}

TEST(Sleeping, AMovingWallWakesWhatItMeets) {
  scene::Scene scene = block_on_floor(3.0);
  auto piston = rough(box("piston", {0.1, 0.4, 0.3}, 1.0, {-1.1, 0, 0.4}, Vector3d::Zero()));
  piston.immovable = true;
  piston.motion = scene::PrescribedMotion{{0.25, 0, 0}};
  scene.bodies.push_back(piston);
  const Trajectory result = run_it(scene);
  ASSERT_TRUE(falls_asleep(result, 0));
  ASSERT_FALSE(times_of(result, EventKind::kWake, 0).empty());
  // 0.5 m at 0.25 m/s, and a step
  EXPECT_NEAR(times_of(result, EventKind::kWake, 0).front(), 2.0, 0.02);
  EXPECT_NEAR(result.frames.back().poses[0].com_world.x(), 0.25, 1e-3);  // pushed along
}

TEST(Sleeping, NoBodySleepsOnAMovingBody) {
  scene::Scene scene = block_on_floor(3.0);
  // so little that it never moves fast enough to be seen
  scene.bodies[1].motion = scene::PrescribedMotion{Vector3d::Zero(), {0, 0, 1e-9}, 1.0};
  EXPECT_FALSE(falls_asleep(run_it(scene), 0));
}

TEST(Sleeping, ABodyThatHangsStillSleepsUntilItIsHit) {
  auto bob = rough(ball("bob", 0.1, 1.0, {0, 0, 1}, Vector3d::Zero())),
       hammer = rough(ball("hammer", 0.1, 1.0, {-2.9, 0, 1}, {2, 0, 0}));
  scene::Scene scene = sleepy({bob, hammer}, 2.0, kGravity);
  scene.bodies[1].position_m.z() = 1 + 0.5 * kG * 1.4 * 1.4 - 0.02;  // falls past it at 1.4 s
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", {0, 0, 2}}, {"bob", Vector3d::Zero()}, 1.0});
  scene.stabilisation.emplace();
  const Trajectory slept = run_it(scene), awake = run_awake(scene);
  ASSERT_TRUE(falls_asleep(slept, 0));
  EXPECT_EQ(times_of(slept, EventKind::kWake, 0).size(), 1u);
  EXPECT_LT(farthest_apart(slept.frames.back(), awake.frames.back()), 1e-9);
}

TEST(Sleeping, WhatHangsCostsNothingAsleep) {
  const auto counts = [](double duration) {
    scene::Scene scene =
        sleepy({rough(ball("bob", 0.1, 1.0, {0, 0, 1}, Vector3d::Zero()))}, duration);
    scene.effects.of<effects::RodSpec>().push_back(
        {"rod", {"", {0, 0, 2}}, {"bob", Vector3d::Zero()}, 1.0});
    scene.stabilisation.emplace();
    return run_it(scene).counters.counts;
  };
  const auto a_while = counts(1.0), longer = counts(3.0);
  for (const char* counter : {"integrations", "derivative_evaluations", "constraint_corrections"})
    EXPECT_EQ(a_while.at(counter), longer.at(counter)) << counter;
}

// With plastic impacts taken with their steps nobody looks for the instant at which the ball comes
// down.
TEST(Sleeping, WhatLandsWithinAStepWakesToo) {
  scene::Scene scene = block_on_floor(2.5);
  scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  // falls for 0.8 s, and is large against its way in a step
  scene.bodies.push_back(
      rough(ball("ball", 1.0, 0.5, {0, 0, 2.0 + 0.5 * kG * 0.64}, Vector3d::Zero())));
  const Trajectory result = run_it(scene);
  ASSERT_FALSE(times_of(result, EventKind::kWake, 0).empty());
  EXPECT_NEAR(times_of(result, EventKind::kWake, 0).front(), 0.8, 2.0 / 60);
  double carried = 0.0;
  for (const ContactPoint& contact : result.frames.back().contacts)
    if (contact.body_b == 1) carried += contact.force_on_a_world.z();
  // the floor carries both, and what they carried asleep is told
  EXPECT_NEAR(carried, 1.5 * kG, 1e-6 * 1.5 * kG);
}

// A ball that rests without persistent contact is hit, too, by what moves by its own law.
TEST(Resting, AMovingWallMeetsABallAtRest) {
  auto wall = box("wall", {0.1, 1, 1}, 1.0, {-1.2, 0, 1.001}, Vector3d::Zero()),
       resting = ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero()),
       floor = plane("floor", Vector3d::Zero(), Vector3d::UnitZ());
  wall.immovable = true;
  wall.motion = scene::PrescribedMotion{{1, 0, 0}};
  resting.restitution = floor.restitution = 0.0;
  const Trajectory result = run(scene_of({wall, resting, floor}, 1.1, kGravity));
  EXPECT_EQ(result.counters.counts.at("bodies_woken"), 1u);
  EXPECT_GE(result.frames.back().smallest_gap, 0.0);
}

}  // namespace
}  // namespace tumble::testing::sleeping_test
