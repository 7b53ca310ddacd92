// Contacts that are dealt with within a step: they give no energy, and what is shown does not
// overlap.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/effects/build_world.h"
#include "framework/effects/drag/drag.h"
#include "framework/engines/base/run_watch.h"
#include "framework/engines/contact/impact_detection.h"
#include "framework/engines/events/process_world.h"
#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing {
namespace {

using engines::RunWatch;

double energy(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

/// Largest rise of energy above the least so far, in frames. [J]
double energy_rise(const Trajectory& run) {
  double least = energy(run.frames.front()), rise = 0.0;
  for (const Frame& frame : run.frames) {
    rise = std::isfinite(energy(frame)) ? std::max(rise, energy(frame) - least)
                                        : std::numeric_limits<double>::infinity();
    least = std::min(least, energy(frame));
  }
  return rise;
}

// ---- Contacts dealt with in the step give no energy --------------------------------------------

// Boxes that touch along edges, one of which a medium slows: what draws them apart is no velocity.
TEST(InStep, NoEnergyComesOfPositionCorrections) {
  for (const char* name :
       {"in_step_exit0", "in_step_explodes", "min_471_runaway", "min_195_energy"}) {
    const scene::Scene scene = broken_scene(name);
    for (const std::string& engine : {std::string("rd"), std::string("ordered")}) {
      const Trajectory run = run_by(engine, scene);
      double scale = run.frames.front().kinetic_energy,
             lowest = run.frames.front().potential_energy;
      for (const Frame& frame : run.frames) lowest = std::min(lowest, frame.potential_energy);
      scale += run.frames.front().potential_energy - lowest;
      // A tenth is what steps of 1/60 s leave of a tipping box; more is told.
      EXPECT_TRUE(energy_rise(run) < 0.1 * scale || has_fault(run, "energy_rises") ||
                  !run.stopped_by.empty())
          << name << ' ' << engine << ": " << energy_rise(run) << " J" << said(run);
      EXPECT_LT(energy_rise(run), 0.1 * scale) << name << ' ' << engine << said(run);
    }
  }
}

/// Boxes of 1 m that touch along faces and edges, where a lattice drawn by lot has them, one of
/// them slowed by a medium, one with a velocity.
scene::Scene touching_boxes(unsigned seed) {
  Random random(seed);
  scene::Scene scene =
      scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ())}, 1.0, kEarthGravity);
  scene.bodies[0].friction = 0.5 * (seed % 2);
  for (int x = 0; x < 2; ++x)
    for (int y = 0; y < 2; ++y)
      for (int z = 0; z < 2; ++z) {
        if (random.between(0.0, 1.0) < 0.4 && !(x == 0 && y == 1 && z == 0)) continue;
        scene::BodySpec body =
            box(fmt::format("b{}{}{}", x, y, z), Vector3d::Constant(0.5), random.between(0.5, 2.0),
                Vector3d(x, y, z + 0.5) * (1 + 1e-12), Vector3d::Zero());
        body.restitution = 0.0;
        body.friction = random.between(0.0, 1.0);
        scene.bodies.push_back(body);
      }
  for (double& velocity : scene.bodies.back().velocity_m_s) velocity = random.between(-0.5, 0.3);
  scene.contact.emplace();
  scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  scene.effects.of<effects::DragSpec>().push_back(
      {scene.bodies[1].name, random.between(0.0, 0.2), 0.0});
  scene.step_s = seed % 3 == 0 ? 1.0 / 1000 : 1.0 / 60;
  return scene;
}

TEST(InStep, BoxesThatTouchByLotGainNothing) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const scene::Scene scene = touching_boxes(seed);
    const Trajectory run = run_by("rd", scene);
    double lowest = run.frames.front().potential_energy;
    for (const Frame& frame : run.frames) lowest = std::min(lowest, frame.potential_energy);
    // J: they may settle a centimetre
    const double scale =
        run.frames.front().kinetic_energy + run.frames.front().potential_energy - lowest + 0.1;
    EXPECT_LT(energy_rise(run), 0.1 * scale) << seed << said(run);
  }
}

// A lid that comes down on a ball on the floor farther than the ball is high: no place is left for
// it.
TEST(RunWatch, ABodyThatIsLeftInAnotherIsNeverKeptSilent) {
  for (const double restitution : {0.0, 0.5}) {
    scene::Scene scene = scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                                   plane("lid", {0, 0, 0.25}, -Vector3d::UnitZ()),
                                   ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero())},
                                  1.0, kEarthGravity);
    for (scene::BodySpec& body : scene.bodies) body.restitution = restitution;
    scene.bodies[1].motion.emplace();
    scene.bodies[1].motion->velocity_m_s = {0, 0, -0.1};
    scene.contact.emplace();
    const Trajectory run = run_by("rd", scene);
    double deepest = 0.0;
    for (const Frame& frame : run.frames) deepest = std::min(deepest, frame.smallest_gap);
    EXPECT_TRUE(deepest > -1e-3 * 0.1 || !run.stopped_by.empty() || !run.counters.faults.empty())
        << restitution << ": " << deepest << " m";
  }
}

/// What is told of a ball of 0.1 m that touches the floor where a lid hangs this high, after places
/// were corrected; of another one beside it, that far above the floor.
std::vector<RunFault> told_under_a_lid(double lid_m, double other_m) {
  const Laws laws = reference_laws();
  engines::RunCounters counters;
  engines::MovingWorld moving(
      build_world(scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                            plane("lid", {0, 0, lid_m}, -Vector3d::UnitZ()),
                            ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero()),
                            ball("other", 0.1, 1.0, {5, 0, other_m}, Vector3d::Zero())},
                           1.0)),
      laws, counters);
  engines::ImpactDetection detection(moving, laws, counters);
  detection.separate({{0, 2}, {0, 3}, {1, 2}, {2, 3}});
  return counters.watch.faults();
}

// Room for three quarters of its diameter: the last round leaves it off the lid, and half a radius
// deep in the floor. The other ball is in nothing.
TEST(RunWatch, ABallBetweenPlanesNearerThanItsDiameterIsAnOverlapLeft) {
  const std::vector<RunFault> faults = told_under_a_lid(0.15, 0.3);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, "overlap_left");
  EXPECT_EQ(faults[0].subject, "'floor' and 'ball'");
  EXPECT_EQ(faults[0].count, 1u);
  EXPECT_NEAR(faults[0].worst, 0.5, 1e-9);  // spacings of a coordinate, a few a round
  EXPECT_TRUE(told_under_a_lid(0.2001, 0.3).empty());
  EXPECT_TRUE(told_under_a_lid(0.2001, 0.05).empty());  // it has room to be moved to
}

// The same ball as a process that meets the floor: a run counts the note where it commits that.
TEST(RunWatch, WhatAnImpactOfAProcessNotesIsPartOfItsResult) {
  scene::Scene scene = scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                                 plane("lid", {0, 0, 0.15}, -Vector3d::UnitZ()),
                                 ball("ball", 0.1, 1.0, {0, 0, 0.1}, Vector3d::Zero())},
                                1.0);
  scene.contact.emplace();
  const World world = build_world(scene);
  std::vector<collision::CollisionShape> shapes;
  for (const WorldBody& body : world.bodies) shapes.emplace_back(body.shape);
  const Laws laws = reference_laws();
  const engines::EntriesByBody entries(world);
  engines::RunCounters counters;
  constexpr int kFloor = 0, kLid = 1, kBall = 2;
  engines::ProcessWorld process(
      world, entries, [&](int body) { return &shapes[static_cast<std::size_t>(body)]; }, laws,
      {scene.step_s, scene.rest_speed_m_s}, counters, {kBall}, {kFloor, kLid});
  engines::ProcessState state;
  state.members = {kBall};
  state.states = {world.bodies[kBall].state};
  for (int again = 0; again < 2; ++again) {  // as after a rollback
    const engines::ProcessWorld::Change change = process.collide({kFloor, kBall}, state);
    ASSERT_TRUE(change.noted);
    EXPECT_EQ(change.noted->faults().at(0).kind, "overlap_left");
    EXPECT_EQ(change.noted->faults().at(0).count, 1u);
  }
  EXPECT_TRUE(counters.watch.empty());
}

TEST(RunWatch, AnOverlapThatNoPictureShowsIsNotNoted) {
  constexpr double kShown = engines::kApart * 0.1;  // m, of this ball
  EXPECT_TRUE(told_under_a_lid(0.2 - 0.5 * kShown, 0.3).empty());
  EXPECT_EQ(told_under_a_lid(0.2 - 2.0 * kShown, 0.3).size(), 1u);
}

TEST(RunWatch, AnOverlapThatIsLeftIsNamedWithoutAStep) {
  RunWatch watch;  // no step would part them
  watch.note(RunWatch::Kind::kOverlapLeft, "'lid' and 'ball'", {0.5, engines::kApart, 0.1, 0.0});
  const auto faults = watch.faults();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, "overlap_left");
  EXPECT_EQ(faults[0].remedy.find("step_s"), std::string::npos) << faults[0].remedy;
  EXPECT_NE(faults[0].remedy.find("room"), std::string::npos) << faults[0].remedy;
}

// ---- What is shown does not overlap ------------------------------------------------------------

/// Two small boxes that fall on a plate and on each other, turned by lot.
scene::Scene falling_boxes(unsigned seed) {
  Random random(seed);
  scene::Scene scene = scene_of(
      {box("plate", {0.3, 0.3, 0.005}, 1.0, {0, 0, -0.005}, Vector3d::Zero())}, 0.5, kEarthGravity);
  scene.bodies[0].immovable = true;
  for (int k = 0; k < 3; ++k) {
    const double aside = random.between(-0.005, 0.005);
    scene::BodySpec body =
        box(fmt::format("b{}", k), Vector3d::Constant(0.008), 0.01,
            {aside, random.between(-0.005, 0.005), 0.03 + 0.03 * k}, Vector3d::Zero());
    body.restitution = k == 0 ? 0.3 : 0.0;
    for (double& part : body.world_from_body.coeffs()) part = random.between(-1.0, 1.0);
    body.world_from_body.normalize();
    scene.bodies.push_back(body);
  }
  scene.contact.emplace();
  if (seed % 2 == 0) scene.contact->plastic_impacts = scene::PlasticImpacts::kInStep;
  scene.step_s = 1.0 / 30;  // every second picture lies within a step
  return scene;
}

TEST(ShownWithinAStep, NothingOverlaps) {
  for (unsigned seed = 1; seed <= 4; ++seed)
    for (const std::string& engine : {std::string("ca"), std::string("ordered")}) {
      const Trajectory run = run_by(engine, falling_boxes(seed));
      for (const Frame& frame : run.frames)
        ASSERT_GE(frame.smallest_gap, 0.0) << engine << " seed " << seed << " at " << frame.time;
    }
}

}  // namespace
}  // namespace tumble::testing
