// Heaps: many bodies in contact that strike each other many times a step.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"

namespace tumble::testing::heaps_test {
namespace {

const Vector3d kGravity(0, 0, -9.81);
constexpr double kThickness = 0.008, kWidth = 0.025, kHeight = 0.05, kSpacing = 0.022;  // m

/// So many dominoes in a row along x; the first is pushed over.
scene::Scene dominoes(int count, double duration, scene::PlasticImpacts plastic) {
  std::vector<scene::BodySpec> bodies{plane("floor", Vector3d::Zero(), Vector3d::UnitZ())};
  for (int i = 0; i < count; ++i)
    bodies.push_back(box("domino " + std::to_string(i), 0.5 * Vector3d(kThickness, kWidth, kHeight),
                         0.01, {i * kSpacing, 0, 0.5 * kHeight}, Vector3d::Zero()));
  for (scene::BodySpec& body : bodies) {
    body.friction = 0.5;
    body.restitution = 0.0;
  }
  bodies[1].omega_world_rad_s = {0, 8, 0};
  bodies[1].velocity_m_s = {0.2, 0, 0};
  scene::Scene scene = scene_of(std::move(bodies), duration, kGravity);
  scene.step_s = 1.0 / 480;
  scene.contact.emplace();
  scene.contact->plastic_impacts = plastic;
  return scene;
}

/// How far a body leans from the vertical. [rad]
double lean(const Frame& frame, int body) {
  return std::acos(std::clamp(
      (frame.poses[static_cast<std::size_t>(body)].world_from_body * Vector3d::UnitZ()).z(), -1.0,
      1.0));
}

/// When a body first leans this far. [s]
double when_leans(const Trajectory& run, int body, double angle) {
  for (const Frame& frame : run.frames)
    if (lean(frame, body) > angle) return frame.time;
  return kUnset;
}

TEST(Heaps, AWaveOfDominoesFallsInAboutTheStepsThatTheSceneAsksFor) {
  const scene::Scene scene = dominoes(20, 1.3, scene::PlasticImpacts::kAutomatic);
  const Trajectory result = run(scene, reference_laws());
  EXPECT_EQ(result.stopped_by, "");
  EXPECT_GT(result.counters.counts.at("large_island_steps"), 0u);
  // impact by impact it is 5 and more; in steps about 2, some more or fewer as they happen to meet
  EXPECT_LT(result.counters.counts.at("steps"), 2.5 * scene.duration_s / scene.step_s);
  ASSERT_EQ(result.counters.notices.size(), 1u);  // and says so
  EXPECT_NE(result.counters.notices[0].find("\"plastic_impacts\": \"located\""), std::string::npos)
      << result.counters.notices[0];
  double least = result.frames.front().kinetic_energy + result.frames.front().potential_energy;
  const double scale = least;
  for (const Frame& frame : result.frames) {
    EXPECT_GE(frame.smallest_gap, 0.0) << "t = " << frame.time;
    const double now = frame.kinetic_energy + frame.potential_energy;
    // the shell of 1e-4 may lift what lies by as much of its size
    EXPECT_LE(now, least + 1e-4 * scale) << "t = " << frame.time;
    least = std::min(least, now);
  }
  // rad; each lies on the next at acos(8/22) = 1.2, the first slide further
  for (int i = 1; i <= 20; ++i) EXPECT_GT(lean(result.frames.back(), i), 0.9) << i;
  for (const BodyPose& pose : result.frames.back().poses)
    EXPECT_LT(pose.velocity_world.norm(), 1e-6);
}

TEST(Heaps, StepsAndInstantsGiveTheSameWave) {
  constexpr int kLast = 13;
  const auto arrivals = [&](scene::PlasticImpacts plastic) {
    const Trajectory result = run(dominoes(kLast, 0.52, plastic), reference_laws());
    EXPECT_EQ(result.counters.counts.at("large_island_steps") > 0,
              plastic == scene::PlasticImpacts::kAutomatic);
    std::vector<double> times;
    for (int i = 1; i <= kLast; ++i) times.push_back(when_leans(result, i, 0.05));
    return times;
  };
  const std::vector<double> in_steps = arrivals(scene::PlasticImpacts::kAutomatic),
                            located = arrivals(scene::PlasticImpacts::kLocated);
  // a frame
  for (int i = 1; i <= kLast; ++i)
    EXPECT_NEAR(in_steps[static_cast<std::size_t>(i - 1)], located[static_cast<std::size_t>(i - 1)],
                1.01 / 60)
        << i;
}

TEST(Heaps, AFewBodiesAreSolvedImpactByImpact) {
  const Trajectory result =
      run(dominoes(8, 0.4, scene::PlasticImpacts::kAutomatic), reference_laws());
  EXPECT_EQ(result.counters.counts.at("large_island_steps"), 0u);
  EXPECT_TRUE(result.counters.notices.empty());
}

}  // namespace
}  // namespace tumble::testing::heaps_test
