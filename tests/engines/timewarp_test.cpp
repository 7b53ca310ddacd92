// Timewarp commits the reference's trace, to the last bit, in any order of execution.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/engines/event_scenes.h"

namespace tumble::testing {
namespace {

using engines::FaultInjection;
using engines::trace_hash;

TEST(CommittedTrace, OfGasIsTheReferencesInTimewarpAndInConservativeAdvancement) {
  expect_the_references_trace(sized("gas", 300, 3.0), 1000);
}

TEST(CommittedTrace, OfPongAmongBoxesIsTheReferences) {
  expect_the_references_trace(sized("pong", 60, 5.0), 200);
}

TEST(CommittedTrace, OfTumblingBoxesUnderGravityIsTheReferences) {
  std::vector<scene::BodySpec> bodies{plane("floor", {0, 0, 0}, {0, 0, 1}),
                                      plane("left", {-2, 0, 0}, {1, 0, 0}),
                                      plane("right", {2, 0, 0}, {-1, 0, 0})};
  for (int i = 0; i < 12; ++i) {
    bodies.push_back(box("box" + std::to_string(i), {0.1, 0.15, 0.2}, 1.0,
                         {-1.2 + 0.8 * (i % 4), 0.3 * (i % 3), 0.8 + 0.6 * (i / 4)},
                         {0.7 - 0.2 * i, 0.1 * i - 0.5, 0.0}));
    bodies.back().omega_world_rad_s = {1.0, 0.3 * i, -2.0};
  }
  expect_the_references_trace(scene_of(bodies, 0.8, Vector3d(0, 0, -9.81)), 20);
}

scene::BodySpec top(const std::string& name, const Vector3d& position, const Vector3d& velocity) {
  // three different moments of inertia
  scene::BodySpec body = box(name, {0.1, 0.2, 0.3}, 1.0, position, velocity);
  body.omega_world_rad_s = {0.1, 3.0, 0.2};
  return body;
}

// The rotation of a body between two events is known in closed form: a body without partners
// advances by its own distance, not by the scene's steps.
TEST(ATurningSolid, AloneTakesAsManyIntegrationsHoweverShortTheStep) {
  scene::Scene scene = scene_of(
      {top("top", Vector3d::Zero(), {0.1, 0.0, 0.0}), plane("floor", {0, 0, -5}, {0, 0, 1})},
      100.0);
  std::vector<std::uint64_t> integrations, checks;
  for (const double step : {1.0 / 30, 1.0 / 3000}) {
    scene.step_s = step;
    const Trajectory run = run_by("tw", scene, {}, 0.1);
    EXPECT_EQ(difference(run_by("ordered", scene, {}, 0.1), run), "");
    integrations.push_back(run.counters.counts.at("integrations"));
    checks.push_back(run.counters.counts.at("pair_checks"));
  }
  EXPECT_EQ(integrations[0], integrations[1]);
  EXPECT_LE(checks[1], integrations[1]) << "the floor is out of reach: one look each time";
  EXPECT_LT(integrations[0], 300U) << "3,000 steps of 1/30 s; a ball of that size goes a quarter "
                                      "of its size at once, 10 m in 67";
}

// From far away, so that each has advanced as if it were alone; the impact sends the first to be
// hit further.
TEST(ATurningSolid, ThatWentFarIsMetWhereItShouldBe) {
  for (const double step : {1.0 / 30, 1.0 / 300}) {
    scene::Scene scene =
        scene_of({top("left", {-6, 0, 0}, {1.0, 0, 0}), top("right", {6, 0.1, 0}, {-2.0, 0, 0}),
                  top("third", {-9, 0.1, 0.1}, {3.0, 0, 0}), plane("wall", {8, 0, 0}, {-1, 0, 0})},
                 12.0);
    scene.step_s = step;
    expect_the_references_trace(scene, 3);
    for (const int regions : {2, 5}) {
      engines::FaultInjection faults;
      faults.regions = regions;
      EXPECT_EQ(difference(run_by("ordered", scene), run_by("tw", scene, faults)), "")
          << regions << " territories";
    }
  }
}

// Processes are executed in random order, up to a quarter of a second ahead of global virtual time.
TEST(AdversarialOrder, LeavesTheTraceAsItIs) {
  const scene::Scene scene = sized("gas", 60, 1.5);
  const Trajectory reference = run_by("ordered", scene);
  ASSERT_GT(reference.events.size(), 100U);
  std::uint64_t rollbacks = 0, anti_messages = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Trajectory run = run_by("tw", scene, {seed, true, 0.25, 0, 0.0});
    ASSERT_EQ(difference(reference, run), "") << "seed " << seed;
    rollbacks += run.counters.counts.at("rollbacks");
    anti_messages += run.counters.counts.at("anti_messages");
  }
  // The random order was hard enough: effects on others were rolled back many times per run.
  EXPECT_GT(rollbacks, 200U * 10);
  EXPECT_GT(anti_messages, 200U * 10);
}

TEST(ForcedRollback, LeavesTheTraceAsItIs) {
  const scene::Scene scene = sized("gas", 100, 2.0);
  const Trajectory reference = run_by("ordered", scene);
  const double three_steps = 3 * scene.step_s;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const int threads : {1, 2}) {
      engines::RunOptions options;
      options.engine = "tw";
      options.threads = threads;
      options.faults = {seed, false, three_steps, 10, three_steps};
      const Trajectory run = run_as_told(std::move(options), scene, test_laws());
      ASSERT_EQ(difference(reference, run), "") << "seed " << seed << ", " << threads << " threads";
      EXPECT_GT(run.counters.counts.at("rollbacks"), 10U)
          << "seed " << seed << ", " << threads << " threads";
    }
}

TEST(ForcedRollback, CostsAtMostThreeTimesAsMuch) {
  const scene::Scene scene = sized("gas", 100, 2.0);
  const double three_steps = 3 * scene.step_s;
  const auto plain = run_by("tw", scene).counters.counts;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto forced = run_by("tw", scene, {seed, false, 0.0, 10, three_steps}).counters.counts;
    for (const char* what : {"integrations", "pair_checks"})
      EXPECT_LE(forced.at(what), 3 * plain.at(what)) << what << ", seed " << seed;
  }
  EXPECT_LE(100 * plain.at("undone_integrations"), 15 * plain.at("integrations"));
}

// Shapes without closed forms, gravity, walls that are boxes, and a shaken plane: every kind of
// check, out of order.
TEST(AdversarialOrder, OfTumblingSolidsLeavesTheTraceAsItIs) {
  std::vector<scene::BodySpec> bodies{
      plane("shaken", {0, 0, 0}, {0, 0, 1}),
      box("wall", {0.05, 3, 3}, 1.0, {1.6, 0, 0}, Vector3d::Zero())};
  bodies[0].motion = scene::PrescribedMotion{Vector3d::Zero(), Vector3d(0, 0, 0.01), 15.0};
  bodies[1].immovable = true;
  bodies[1].mass_kg.reset();
  for (int i = 0; i < 6; ++i) {
    bodies.push_back(box("box" + std::to_string(i), {0.1, 0.15, 0.2}, 1.0,
                         {-0.8 + 0.8 * (i % 3), 0.5 * (i / 3), 0.4}, {0.9 - 0.3 * i, 0.2, 0.0}));
    bodies.back().omega_world_rad_s = {1.0, 0.3 * i, -2.0};
    bodies.push_back(ball("ball" + std::to_string(i), 0.1, 0.5,
                          {-0.8 + 0.8 * (i % 3), 0.5 * (i / 3), 1.0}, {0.2 * i - 0.5, -0.3, -0.5}));
  }
  const scene::Scene scene = scene_of(bodies, 0.6, Vector3d(0, 0, -9.81));
  const Trajectory reference = run_by("ordered", scene);
  ASSERT_GT(reference.events.size(), 15U);
  std::uint64_t rollbacks = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const Trajectory run = run_by("tw", scene, {seed, true, 0.2, 9, 0.05});
    ASSERT_EQ(difference(reference, run), "") << "seed " << seed;
    rollbacks += run.counters.counts.at("rollbacks");
  }
  EXPECT_GT(rollbacks, 30U);
}

TEST(CommittedTrace, OfBallsAndMoleculesIsTheReferences) {
  expect_the_references_trace(sized("atoms", 45, 0.7), 50);
}

TEST(CommittedTrace, OfBallsThatIgnoreEachOtherHoldsNoneOfTheirCollisions) {
  const scene::Scene scene = sized("pong_ghosts", 40, 2.0);
  const Trajectory reference = run_by("ordered", scene);
  ASSERT_GT(reference.events.size(), 10U);
  for (const Event& event : reference.events) EXPECT_LT(event.body_a, 4);  // a wall
  EXPECT_EQ(difference(reference, run_by("tw", scene)), "");
  EXPECT_EQ(run_by("rd", scene).events.size(), reference.events.size());
}

}  // namespace
}  // namespace tumble::testing
