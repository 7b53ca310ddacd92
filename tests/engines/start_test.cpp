// What a scene says of the start and what a run begins with: overlaps of roundings are taken back,
// velocities that rods and joints do not allow are changed, and both are told of, by every engine
// alike.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

Trajectory run_in(const std::string& engine, const scene::Scene& scene) {
  static const Laws laws = reference_laws();
  engines::RunOptions options;
  options.engine = engine;
  return run_as_told(std::move(options), scene, laws);
}

std::string notices_of(const Trajectory& run) {
  std::string all;
  for (const std::string& notice : run.counters.notices) all += notice + "\n";
  return all;
}

/// Three boxes of an edge, one on the other on a floor, each `deep` in what it stands on.
scene::Scene stack(double edge, double deep, const Vector3d& place, bool with_contact) {
  std::vector<scene::BodySpec> bodies{plane("floor", place, {0, 0, 1})};
  for (int i = 0; i < 3; ++i)
    bodies.push_back(box("box" + std::to_string(i), Vector3d::Constant(edge / 2), 1.0,
                         place + Vector3d(0, 0, (i + 0.5) * edge - (i + 1) * deep),
                         Vector3d::Zero()));
  for (scene::BodySpec& body : bodies) body.restitution = 0.0;
  // without contact nothing lies
  scene::Scene scene = scene_of(std::move(bodies), 0.05,
                                with_contact ? std::optional<Vector3d>(kEarth) : std::nullopt);
  if (with_contact) scene.contact = scene::ContactSpec{};
  scene.step_s = 1.0 / 240.0;
  return scene;
}

TEST(Start, OverlapsThatRoundingExplainsAreRemovedAndReported) {
  // Half a spacing of float32 numbers of the place and half of the size, for each of the two: 2^-23
  // of their sum explains the deepest.
  for (const std::string& engine : kEngines)
    for (const bool with_contact : {true, false})
      for (const auto& [edge, deep, far] : {std::tuple{1.0, 1e-12, 0.0},
                                            {1.0, 1e-8, 0.0},
                                            {0.01, 1e-10, 0.0},
                                            {50.0, 1e-7, 0.0},
                                            {1.0, 1e-6, 100.0}}) {
        const Trajectory run = run_in(engine, stack(edge, deep, {far, 0, 0}, with_contact));
        const std::string who = engine + (with_contact ? ", contact" : "") + ", " +
                                std::to_string(deep) + " of " + std::to_string(edge);
        EXPECT_EQ(run.stopped_by, "") << who;
        const std::string told = notices_of(run);
        for (const char* words :
             {"overlapped at the start by",
              "rounding of decimals or of single-precision models explains", "moved apart"})
          EXPECT_NE(told.find(words), std::string::npos) << who << ": " << told;
        ASSERT_FALSE(run.frames.empty()) << who;
        EXPECT_GE(run.frames.front().smallest_gap, 0.0) << who;
        // The top box is raised by what all three were in each other, and no more than roundings
        // and contact margins of 1e-10 of its size.
        EXPECT_NEAR(run.frames.front().poses[3].com_world.z(), 2.5 * edge, 1e-9 * edge) << who;
      }
}

TEST(Start, OverlapsThatRoundingDoesNotExplainAreRefusedWithBothNumbers) {
  for (const std::string& engine : kEngines) try {
      run_in(engine, stack(1.0, 1e-5, {0, 0, 0}, true));
      ADD_FAILURE() << engine << " accepts an overlap of 10 micrometres";
    } catch (const UserError& error) {
      const std::string said = error.what();
      for (const char* words : {"bodies 'floor' and 'box0' overlap at the start, by about 1e-05 m",
                                "explains 1.", "e-07 m here", "position_m"})
        EXPECT_NE(said.find(words), std::string::npos) << engine << ": " << said;
    }
}

TEST(Start, ABodyWedgedBetweenTwoWallsIsRefused) {
  // 1e-8 m too wide for its slot: no shift helps.
  scene::Scene scene =
      scene_of({plane("left", {0, 0, 0}, {1, 0, 0}), plane("right", {1.0 - 1e-8, 0, 0}, {-1, 0, 0}),
                box("box", {0.5, 0.5, 0.5}, 1.0, {0.5 - 5e-9, 0, 0}, Vector3d::Zero())},
               0.1, kEarth);
  for (const std::string& engine : kEngines)
    EXPECT_THROW(run_in(engine, scene), UserError) << engine;
}

/// A bob on a rod along x, thrown with (1, 2, 0): what it can have is (0, 2, 0).
scene::Scene thrown_bob(const Vector3d& velocity) {
  scene::Scene scene = scene_of({ball("bob", 0.1, 1.0, {1, 0, 0}, velocity)}, 0.1, std::nullopt);
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", Vector3d::Zero()}, {"bob", Vector3d::Zero()}, 1.0});
  scene.stabilisation = scene::StabilisationSpec{};
  return scene;
}

TEST(Start, VelocitiesThatARodDoesNotAllowAreReportedWithTheirCorrection) {
  for (const std::string& engine : kEngines) {
    const std::string told = notices_of(run_in(engine, thrown_bob({1, 2, 0})));
    for (const char* words : {"the start velocities of 'bob' do not fit what holds it ('rod')",
                              "changed by 1 m/s", "\"velocity_m_s\" (", "2, 0)"})
      EXPECT_NE(told.find(words), std::string::npos) << engine << ": " << told;
    EXPECT_EQ(notices_of(run_in(engine, thrown_bob({0, 2, 0}))), "")
        << engine << ": velocities that fit are worth no word";
    EXPECT_EQ(notices_of(run_in(engine, thrown_bob({1e-7, 2, 0}))), "")
        << engine << ": nor is what typed decimals leave";
  }
}

TEST(Start, VelocitiesThatAJointDoesNotAllowAreReportedByBody) {
  scene::Scene scene =
      scene_of({box("door", {0.5, 0.05, 1.0}, 20.0, {0.5, 0, 0}, {0, 0, 1})}, 0.05, std::nullopt);
  scene.effects.of<effects::JointSpec>().push_back(
      {"hinge", effects::JointKind::kHinge, "door", "", Vector3d::Zero(), Vector3d::UnitZ()});
  scene.stabilisation = scene::StabilisationSpec{};
  for (const std::string& engine : kEngines) {
    const std::string told = notices_of(run_in(engine, scene));
    EXPECT_NE(told.find("the start velocities of 'door' do not fit what holds it ('hinge')"),
              std::string::npos)
        << engine << ": " << told;
  }
}

// A place in the world that was written down as one in the body's frame is told of, by every engine
// alike; a point on the body, or a pivot just beside it, is not.
TEST(Start, APointFarOutsideItsBodyIsReported) {
  const auto told = [](const std::string& engine, const Vector3d& point_body) {
    scene::Scene scene = scene_of({ball("ball", 0.2, 1.0, {1, 0, 1}, Vector3d::Zero())}, 0.05);
    scene.step_s = 1.0 / 240.0;
    scene.effects.of<effects::RodSpec>() = {
        {"r", {"ball", point_body}, {"", {1, 0, 3}}, (Vector3d(0, 0, 2) - point_body).norm()}};
    scene.stabilisation.emplace();
    return notices_of(run_in(engine, scene));
  };
  for (const std::string& engine : kEngines) {
    const std::string far = told(engine, {1, 0, 1});
    for (const char* words : {"rod 'r' holds body 'ball' at a point 1.41 m", "0.2 m",
                              "\"point_body_m\"", "\"point_world_m\""})
      EXPECT_NE(far.find(words), std::string::npos) << engine << ": " << words << "\n" << far;
    for (const double up : {0.0, 0.2, 0.29})
      EXPECT_EQ(told(engine, {0, 0, up}).find("at a point"), std::string::npos) << engine << up;
  }
}

// A joint to the world makes a pendulum of a bob; between two bodies it has to be on one of them.
TEST(Start, AJointFarFromBothOfItsBodiesIsReported) {
  const auto told = [](const std::string& other, double x) {
    scene::Scene scene = scene_of({ball("a", 0.2, 1.0, {0, 0, 1}, Vector3d::Zero()),
                                   ball("b", 0.2, 1.0, {1, 0, 1}, Vector3d::Zero())},
                                  0.05);
    scene.step_s = 1.0 / 240.0;
    scene.effects.of<effects::JointSpec>() = {
        {"j", effects::JointKind::kBall, "a", other, {x, 0, 1}, Vector3d::UnitZ()}};
    scene.stabilisation.emplace();
    return notices_of(run_in("rd", scene)).find("joint 'j' holds body") != std::string::npos;
  };
  EXPECT_TRUE(told("b", 5));
  EXPECT_FALSE(told("b", 1.1));
  EXPECT_FALSE(told("", 5));
}

TEST(Start, AForceThatPushesFarOutsideItsBodyIsReported) {
  const auto told = [](double x, double start) {
    scene::Scene scene = scene_of({ball("ball", 0.2, 1.0, {1, 0, 1}, Vector3d::Zero())}, 0.05);
    scene.effects.of<effects::PointForceSpec>() = {{"ball", {1, 0, 0}, {x, 0, 1}, start, 0.01}};
    return notices_of(run_in("rd", scene));
  };
  EXPECT_NE(told(0, 0).find("a force pushes body 'ball' at a point 1 m from"), std::string::npos);
  EXPECT_EQ(told(0.8, 0), "");
  EXPECT_EQ(told(0, 0.02), "");  // where the body is then is not known
}

}  // namespace
}  // namespace tumble::testing
