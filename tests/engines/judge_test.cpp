// Checks of links, contacts, rest and falls, on runs made by hand: each returns the number with
// which the run was made, and fails a wrong run.
#include "framework/engines/judging/judge.h"

#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"

namespace tumble::engines {
namespace {

using scene::CheckSpec;
using Pose = std::function<BodyPose(double time)>;

constexpr double kPi = std::numbers::pi;
// Places and angles of order 1 through some ten operations.
constexpr double kRounding = 1e-14;

BodyPose at(const Vector3d& place, const Quaterniond& turn = Quaterniond::Identity()) {
  return {place, turn, Vector3d::Zero(), Vector3d::Zero()};
}
Quaterniond turned(double angle, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(angle, axis));
}

/// A scene of two movable boxes and a fixed one; a run of one second at 10 frames a second, with
/// given motions.
struct HandMade {
  scene::Scene scene;
  Trajectory run;

  HandMade(const Pose& first, const Pose& second) {
    const std::vector<Pose> poses = {first, second, [](double) { return at(Vector3d::Zero()); }};
    const std::vector<std::string> names = {"first", "second", "floor"};
    for (std::size_t i = 0; i < names.size(); ++i) {
      scene::BodySpec body;
      body.name = names[i];
      body.shape = scene::BoxSpec{{0.5, 0.5, 0.5}};
      body.immovable = i == 2;
      if (!body.immovable) body.mass_kg = 2.0;
      const BodyPose start = poses[i](0.0);
      body.position_m = start.com_world;
      body.world_from_body = start.world_from_body;
      scene.bodies.push_back(body);
      run.bodies.push_back({names[i], body.immovable});
    }
    for (int k = 0; k <= 10; ++k) {
      Frame frame;
      frame.time = 0.1 * k;
      for (const Pose& pose : poses) frame.poses.push_back(pose(frame.time));
      run.frames.push_back(frame);
    }
  }
};

Pose stays(const Vector3d& place) {
  return [=](double) { return at(place); };
}

CheckSpec check_of(const std::string& kind, double tolerance) {
  CheckSpec check;
  check.kind = kind;
  check.tolerance = tolerance;
  return check;
}

CheckResult judged(HandMade made, const CheckSpec& check) {
  made.scene.checks = {check};
  return judge_run(made.scene, made.run).front();
}

void expect_value(const HandMade& made, CheckSpec check, double value) {
  const CheckResult result = judged(made, check);
  EXPECT_NEAR(result.value, value, kRounding) << check.kind << ": " << result.detail;
  EXPECT_EQ(result.passed, result.at_least ? value >= result.threshold : value <= result.threshold)
      << check.kind;
}

TEST(Judge, ARodIsAsLongAsItsEndsAreFarApart) {
  // The second body rotates about its centre: the end of the rod moves from a distance of 1 m to 2
  // m.
  HandMade made(stays({0, 0, 0}), [](double t) {
    return at({1.5, 0, 0}, turned(kPi * t, Vector3d::UnitZ()));
  });
  made.scene.effects.of<effects::RodSpec>().push_back(
      {"stick", {"first", {0, 0, 0}}, {"second", {-0.5, 0, 0}}, 1.0, ""});
  expect_value(made, check_of("rod_length", 1e-6), 1.0);
  made.run.frames.resize(1);
  expect_value(made, check_of("rod_length", 1e-6), 0.0);
  made.scene.effects.of<effects::RodSpec>().clear();
  EXPECT_FALSE(judged(made, check_of("rod_length", 1e-6)).passed)
      << "nothing to judge is not right";
}

TEST(Judge, RestitutionIsAskedOfImpactsNotOfBodiesThatTouchWithoutApproach) {
  HandMade made(stays({0, 0, 0}), stays({2, 0, 0}));
  for (scene::BodySpec& body : made.scene.bodies) body.restitution = 0.5;
  const Event touch{0.5, EventKind::kCollision, 0, 1, Vector3d::Zero(), Vector3d::UnitX(), 0.0, 0.0,
                    0.0};
  made.run.events = {touch};
  EXPECT_FALSE(judged(made, check_of("restitution_law", 1e-9)).passed)
      << "nothing to judge is not right";
  made.run.events.push_back(
      {0.6, EventKind::kCollision, 0, 1, Vector3d::Zero(), Vector3d::UnitX(), 3.0, -2.0, 1.0});
  expect_value(made, check_of("restitution_law", 1e-9), 0.0);
  made.run.events.back().normal_velocity_after = 1.5;
  expect_value(made, check_of("restitution_law", 1e-9), 0.25);
}

TEST(Judge, AHingeOpensByTheDistanceOfItsPointsAndTheAngleOfItsAxes) {
  // The second body leans by 0.3 t about the shared point, which separates by 0.02 t.
  const Vector3d point(0.5, 0, 0);
  HandMade made(stays({0, 0, 0}), [&](double t) {
    const Quaterniond lean = turned(0.3 * t, Vector3d::UnitX());
    return at(point + 0.02 * t * Vector3d::UnitY() + lean * Vector3d(0.5, 0, 0), lean);
  });
  effects::JointSpec hinge;
  hinge.name = "hinge";
  hinge.kind = effects::JointKind::kHinge;
  hinge.body_a = "first";
  hinge.body_b = "second";
  hinge.point_m = point;
  made.scene.effects.of<effects::JointSpec>().push_back(hinge);
  expect_value(made, check_of("joint_gap", 1e-6), 0.02);
  expect_value(made, check_of("joint_angle", 1e-6), 0.3);
  // rotation about its own axis is free
  made.scene.effects.of<effects::JointSpec>()[0].axis = Vector3d::UnitX();
  expect_value(made, check_of("joint_angle", 1e-6), 0.0);
  made.scene.effects.of<effects::JointSpec>()[0].kind = effects::JointKind::kWeld;
  expect_value(made, check_of("joint_angle", 1e-6), 0.3);
  // to the world: the first body does not move
  made.scene.effects.of<effects::JointSpec>()[0].body_b = "";
  expect_value(made, check_of("joint_gap", 1e-6), 0.0);
}

TEST(Judge, TheForceInALinkIsComparedRelativeToTheExpectedForce) {
  HandMade made(stays({0, 0, 0}), stays({1, 0, 0}));
  made.scene.effects.of<effects::SpringSpec>().push_back({"coil", {}, {}, 1, 0, 1, ""});
  made.scene.effects.of<effects::RodSpec>().push_back({"stick", {}, {}, 1, ""});
  for (Frame& frame : made.run.frames) {
    frame.spring_forces = {-3.0};
    frame.rod_tensions = {20.0 * frame.time};
  }
  CheckSpec check = check_of("link_force", 0.06);
  check.link = "stick";
  check.expected = {19.0};
  expect_value(made, check, 1.0 / 19.0);
  check.at_s = 0.5;
  EXPECT_FALSE(judged(made, check).passed);
  check.at_s = 0.55;
  EXPECT_EQ(judged(made, check).value, std::numeric_limits<double>::infinity())
      << "no frame is recorded then";
  check.at_s = 0.0;
  check.link = "coil";
  check.expected = {0.0};
  expect_value(made, check, 3.0);  // N
  for (Frame& frame : made.run.frames) frame.spring_forces.clear();
  EXPECT_FALSE(judged(made, check).passed) << "a run without forces is not right";
}

TEST(Judge, AReactionIsTheSumOverTheContactsWithOneOther) {
  HandMade made(stays({0, 0, 0}), stays({1, 0, 0}));
  Frame& last = made.run.frames.back();
  last.contacts.push_back({0, 2, {0, 0, 0}, {0, 0, 1}, {1, 0, 6}});
  // on the floor, from the first
  last.contacts.push_back({2, 0, {0, 0, 0}, {0, 0, -1}, {0, 0, -4}});
  last.contacts.push_back({0, 1, {0, 0, 0}, {0, 0, 1}, {0, 0, 100}});
  CheckSpec check = check_of("reaction", 1e-9);
  check.body = "first";
  check.axis = Vector3d::UnitZ();
  check.expected = {10.0};
  check.other = "floor";
  expect_value(made, check, 0.0);
  check.other.clear();
  expect_value(made, check, 10.0);
  last.contacts.clear();
  expect_value(made, check, 1.0);
}

TEST(Judge, DriftAndTiltAreTheLargestSinceTheInstant) {
  HandMade made(
      [](double t) {
        return at({0.1 * t, 0, 0}, turned(0.4 * t, Vector3d::UnitY()));
      },
      stays({3, 0, 0}));
  expect_value(made, check_of("drift", 1e-3), 0.1);
  expect_value(made, check_of("tilt", 1e-3), 0.4);
  CheckSpec later = check_of("drift", 0.06);
  later.at_s = 0.5;
  expect_value(made, later, 0.05);
  later.body = "second";
  expect_value(made, later, 0.0);
  later.at_s = 2.0;
  EXPECT_FALSE(judged(made, later).passed) << "the run ended before";
}

TEST(Judge, AtRestNothingMovesOrTurns) {
  HandMade made(stays({0, 0, 0}), stays({3, 0, 0}));
  expect_value(made, check_of("at_rest", 1e-8), 0.0);
  made.run.frames.back().poses[1].velocity_world = {0, 0.2, 0};
  expect_value(made, check_of("at_rest", 1e-8), 0.02);  // v^2 / 2
  made.run.frames.back().poses[1].velocity_world.setZero();
  made.run.frames.back().poses[1].omega_world = {0, 0, 3};
  // w^2 / 2 of a cube of edge 1 m, whose moment is m / 6
  expect_value(made, check_of("at_rest", 1e-8), 0.75);
  made.run.frames[5].poses[0].velocity_world = {2, 0, 0};
  CheckSpec since = check_of("at_rest", 1e-8);
  since.at_s = 0.45;
  expect_value(made, since, 2.0);
  made.run.frames.back().poses[1].omega_world.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(judged(made, since).passed);
}

TEST(Judge, AnExpectedMomentumIsComparedAtItsInstant) {
  HandMade made(stays({0, 0, 0}), stays({3, 0, 0}));
  for (Frame& frame : made.run.frames) frame.momentum_world = {4 * frame.time, 0, 0};
  CheckSpec check = check_of("momentum", 1e-6);
  check.expected = {4, 0, 3};
  expect_value(made, check, 3.0);
  check.at_s = 0.5;
  check.expected = {2, 0, 0};
  expect_value(made, check, 0.0);
  check.at_s = 0.55;
  EXPECT_FALSE(judged(made, check).passed) << "no frame is recorded then";
}

TEST(Judge, ACommonCentreOfMassIsWeighed) {
  HandMade made([](double t) { return at({3 * t, 0, 0}); }, stays({9, 0, 0}));  // of equal masses
  CheckSpec centre = check_of("centre_of_mass", 0.01);
  centre.expected = {6, 0, 0};
  expect_value(made, centre, 0.0);
  centre.at_s = 0.5;
  expect_value(made, centre, 0.75);
  centre.bodies = {"first", "second"};
  expect_value(made, centre, 0.75);
}

TEST(Judge, ADistanceAndAnAngleAreMeasuredFromTheStart) {
  HandMade made(
      [](double t) {
        return at({1 + 3 * t, 4 * t, 0}, turned(7.0 * t, Vector3d::UnitZ()));
      },
      stays({9, 0, 0}));
  CheckSpec way = check_of("distance_travelled", 0.01);
  way.body = "first";
  way.expected = {5.0};
  expect_value(made, way, 0.0);
  way.axis = -Vector3d::UnitX();
  way.expected = {-3.0};
  expect_value(made, way, 0.0);
  way.at_s = 0.5;
  expect_value(made, way, 1.5);
  CheckSpec angle = check_of("angle_at", 0.01);
  angle.body = "first";
  angle.axis = Vector3d::UnitZ();
  angle.expected = {7.0};  // more than a whole turn
  expect_value(made, angle, 0.0);
  angle.axis = -Vector3d::UnitZ();
  expect_value(made, angle, 14.0);
}

// A body that turns 40 rad from frame to frame, ever faster or slower: its angle is 400 t + b t^2 / 2.
// Where its rate changes by 2 pi / 0.1 s and more from one to the next, nobody knows its turns.
TEST(Judge, AnAngleCountsWholeTurnsBetweenFrames) {
  for (const double b : {0.0, 500.0, -600.0, 700.0}) {
    HandMade made(
        [&](double t) {
          BodyPose pose = at({0, 0, 0}, turned((400.0 + 0.5 * b * t) * t, Vector3d::UnitZ()));
          pose.omega_world = (400.0 + b * t) * Vector3d::UnitZ();
          return pose;
        },
        stays({9, 0, 0}));
    CheckSpec angle = check_of("angle_at", 1e-9);
    angle.body = "first";
    angle.axis = Vector3d::UnitZ();
    angle.expected = {400.0 + 0.5 * b};
    const CheckResult result = judged(made, angle);
    EXPECT_EQ(result.passed, b < 628.0) << b << ": " << result.detail;
    EXPECT_EQ(result.detail.find("too far from frame to frame") != std::string::npos, b > 628.0);
  }
}

TEST(Judge, WhatStandsDoesNotLeanAndWhatFallsDoes) {
  HandMade made(
      [](double t) {
        return at({0, 0, 0}, turned(1.5 * t, Vector3d::UnitX()));
      },
      [](double t) {
        return at({3, 0, 0}, turned(0.1 * t, Vector3d::UnitX()));
      });
  CheckSpec check = check_of("stands", 0.5);
  check.axis = Vector3d::UnitZ();
  expect_value(made, check, 1.5);
  check.body = "second";
  expect_value(made, check, 0.1);
  check.kind = "falls";
  expect_value(made, check, 0.1);
  check.body = "first";
  expect_value(made, check, 1.5);
  EXPECT_TRUE(judged(made, check).passed);
  check.bodies = {"first", "second"};
  check.body.clear();
  EXPECT_FALSE(judged(made, check).passed) << "one of the two stands";
}

TEST(Judge, DominoesFallInTheirOrder) {
  HandMade made(
      [](double t) {
        return at({0, 0, 0}, turned(1.5 * t, Vector3d::UnitX()));
      },
      [](double t) {
        return at({3, 0, 0}, turned(std::max(0.0, t - 0.4), Vector3d::UnitX()));
      });
  CheckSpec check = check_of("order_of_falls", 0.0);
  check.axis = Vector3d::UnitZ();
  check.bodies = {"first", "second"};
  check.expected = {0.5};
  expect_value(made, check, 0.0);
  check.bodies = {"second", "first"};
  expect_value(made, check, 1.0);
  check.bodies = {"first", "second"};
  check.expected = {1.0};  // the second never leans that far
  expect_value(made, check, 1.0);
}

/// At rest a hundred metres up: its energy varies by roundings of m g z = 1962 J, and has no other
/// scale.
HandMade at_rest_high_up(double tremble_j) {
  HandMade made(stays({0, 0, 100}), stays({0, 0, 50}));
  effects::set_gravity(made.scene, Vector3d(0, 0, -9.81));
  made.scene.step_s = 0.01;
  for (std::size_t k = 0; k < made.run.frames.size(); ++k) {
    made.run.frames[k].kinetic_energy = 0.0;
    made.run.frames[k].potential_energy = 2943.0 + (k % 2 == 0 ? 0.0 : tremble_j);
    made.run.frames[k].smallest_gap = -9e-19;
  }
  return made;
}

TEST(Judge, RoundingOfLargeTermsIsNoRiseOfEnergy) {
  // The spacing of doubles at 2943 J is 4.5e-13 J. A hundred steps may add up to about ten of
  // these; a microjoule is far above.
  for (const char* kind : {"energy", "energy_not_rising"}) {
    HandMade rounded = at_rest_high_up(9e-13), wrong = at_rest_high_up(1e-6);
    rounded.scene.checks = wrong.scene.checks = {check_of(kind, 1e-3)};
    rounded.scene.checks[0].tolerance = wrong.scene.checks[0].tolerance = 0.0;
    EXPECT_TRUE(judge_run(rounded.scene, rounded.run)[0].passed) << kind;
    EXPECT_FALSE(judge_run(wrong.scene, wrong.run)[0].passed) << kind;
  }
}

TEST(Judge, AGapBelowZeroByARoundingOfPlacesIsNone) {
  HandMade made = at_rest_high_up(0.0);
  made.scene.checks = {check_of("gap", 0.0)};
  EXPECT_TRUE(judge_run(made.scene, made.run)[0].passed);
  made.run.frames[3].smallest_gap = -1e-11;  // a hundred times the rounding of positions of 100 m
  EXPECT_FALSE(judge_run(made.scene, made.run)[0].passed);
}

}  // namespace
}  // namespace tumble::engines
