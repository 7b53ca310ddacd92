// Bodies that touch something and cannot give way: because rods and joints hold them, which is well,
// and because a driven body presses them against another, which ends the run.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_runs.h"

namespace tumble::testing {
namespace {

void hold(scene::Scene& scene, effects::JointKind kind, const std::string& body,
          const Vector3d& point, const Vector3d& axis = Vector3d::UnitY()) {
  scene.effects.of<effects::JointSpec>().push_back(
      {"joint of " + body, kind, body, "", point, axis});
}

/// Whether nothing has moved, by the sizes of the scene, and nothing is said of the run.
void expect_still(const std::string& engine, const scene::Scene& scene, double size) {
  const Trajectory result = run_on(engine, scene);
  EXPECT_EQ(result.stopped_by, "") << engine;
  EXPECT_EQ(faults_of(result), "") << engine;
  ASSERT_FALSE(result.frames.empty()) << engine;
  for (std::size_t i = 0; i < result.frames.back().poses.size(); ++i)
    // a margin of contacts is 1e-10 of the bodies, and the start may take it up
    EXPECT_LE(
        (result.frames.back().poses[i].com_world - result.frames.front().poses[i].com_world).norm(),
        1e-9 * size)
        << engine << ", body " << i;
}

scene::Scene touching(std::vector<scene::BodySpec> bodies) {
  scene::Scene scene = scene_of(std::move(bodies), 0.2, kEarth);
  scene.contact.emplace();
  scene.step_s = 1.0 / 240;
  return scene;
}

TEST(HeldContacts, ABoxWeldedToTheWorldStandsOnTheFloor) {
  scene::Scene scene = touching({plane("floor", {0, 0, 0}, {0, 0, 1}),
                                 box("box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.1}, {0, 0, 0})});
  hold(scene, effects::JointKind::kWeld, "box", {0, 0, 0.1});
  for (const char* engine : {"rd", "tw"}) expect_still(engine, scene, 0.1);
}

// The points beside the hinges cannot part: they lie on their axes.
TEST(HeldContacts, TwoHingedBarsHangSideBySide) {
  scene::Scene scene = touching({box("a", {0.05, 0.05, 0.5}, 1.0, {0, 0, -0.5}, {0, 0, 0}),
                                 box("b", {0.05, 0.05, 0.5}, 1.0, {0.1, 0, -0.5}, {0, 0, 0})});
  hold(scene, effects::JointKind::kHinge, "a", {0, 0, 0});
  hold(scene, effects::JointKind::kHinge, "b", {0.1, 0, 0});
  for (const char* engine : {"rd", "tw"}) expect_still(engine, scene, 0.5);
}

TEST(HeldContacts, ABobOnARodTouchesTheFloor) {
  scene::Scene scene = touching(
      {plane("floor", {0, 0, 0}, {0, 0, 1}), ball("bob", 0.1, 1.0, {0, 0, 0.1}, {0, 0, 0})});
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", {0, 0, 1.1}}, {"bob", Vector3d::Zero()}, 1.0});
  for (const char* engine : {"rd", "tw"}) expect_still(engine, scene, 0.1);
}

// Of any size and any joint, turned any way, on a floor that faces any way.
TEST(HeldContacts, HeldBodiesDrawnByLotStandStill) {
  Random random(7);
  for (int round = 0; round < 60; ++round) {
    const double size = std::pow(10.0, random.between(-3.0, 2.0));
    const Vector3d up =
        Vector3d(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)).normalized();
    const Vector3d half = size * Vector3d(random.between(0.2, 1.0), random.between(0.2, 1.0),
                                          random.between(0.2, 1.0));
    scene::BodySpec body =
        box("box", half, std::pow(10.0, random.between(-3.0, 3.0)), half.z() * up, {0, 0, 0});
    body.world_from_body = shortest_turn(Vector3d::UnitZ(), up);
    body.friction = random.below(2) == 0 ? 0.0 : 0.5;
    scene::Scene scene = touching({plane("floor", {0, 0, 0}, up), body});
    scene.duration_s = 0.05;
    // what leaves it a freedom leaves none along the floor's normal: a hinge along it, or a weld
    const bool is_hinge = random.below(2) == 0;
    hold(scene, is_hinge ? effects::JointKind::kHinge : effects::JointKind::kWeld, "box",
         half.z() * up, up);
    SCOPED_TRACE(fmt::format("round {}: {} of {:.3g} m and {:.3g} kg, friction {}", round,
                             is_hinge ? "hinge" : "weld", size, *body.mass_kg, body.friction));
    expect_still("rd", scene, size);
  }
}

// A lid comes down on a box that stands on the floor.
TEST(HeldContacts, WhatADrivenBodyPressesAgainstAnotherEndsTheRunAtOnce) {
  struct Case {
    const char* engine;
    double restitution, friction;
  };
  for (const auto& [engine, restitution, friction] :
       {Case{"rd", 0, 0}, {"tw", 0, 0.5}, {"rd", 0, 0.5}, {"rd", 0.5, 0}, {"tw", 0.5, 0}}) {
    scene::BodySpec lid = box("lid", {0.5, 0.5, 0.05}, 1.0, {0, 0, 0.3}, {0, 0, 0});
    lid.immovable = true;
    lid.motion.emplace();
    lid.motion->velocity_m_s = {0, 0, -0.1};
    scene::Scene scene = touching({plane("floor", {0, 0, 0}, {0, 0, 1}), lid,
                                   box("box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.1}, {0, 0, 0})});
    for (scene::BodySpec& body : scene.bodies) {
      body.friction = friction;
      body.restitution = restitution;
    }
    scene.duration_s = 1.0;
    const Trajectory result = run_on(engine, scene);
    EXPECT_NE(result.stopped_by.find("(\"motion\") must leave them room"), std::string::npos)
        << engine << ", e = " << restitution << ", friction " << friction << ": "
        << result.stopped_by;
    ASSERT_FALSE(result.frames.empty());
    EXPECT_NEAR(result.frames.back().time, 0.5, 0.02);  // the lid arrives after 0.05 m
  }
}

}  // namespace
}  // namespace tumble::testing
