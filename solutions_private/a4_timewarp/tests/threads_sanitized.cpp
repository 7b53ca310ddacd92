// The fast scheduler under ThreadSanitizer: its own sources, and the framework's that its threads
// run, are compiled with it. A scene for each kind of thing that they share: free flights, turning
// solids, contacts, links, callbacks, caps of states, ties.
#include <gtest/gtest.h>

#include "tests/engines/event_process_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

struct Told {
  std::vector<engines::Callback> callbacks{};
  int most_states = 0;
  std::uint64_t least_rounds = 3;
};

Trajectory run_on(int threads, const scene::Scene& scene, const Laws& laws,
                  engines::RunOptions options) {
  TrajectoryRecorder recorder;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.threads = threads;
  options.faults.delay_s = 20e-6;
  options.faults.seed = static_cast<std::uint64_t>(threads);
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

// A race ends the program with an exit code of its own, whatever the traces say.
void expect_one_trace(const scene::Scene& scene, const Laws& laws, const Told& told = {}) {
  engines::RunOptions options;
  options.callbacks = told.callbacks;
  options.most_states = told.most_states;
  const Trajectory one = run_on(1, scene, laws, options);
  ASSERT_EQ(one.stopped_by, "");
  for (const int threads : {2, 4}) {
    const Trajectory run = run_on(threads, scene, laws, options);
    EXPECT_EQ(difference(one, run), "") << threads << " threads";
    EXPECT_GE(run.counters.counts.at("rounds_of_threads"), told.least_rounds)
        << threads << " threads";
  }
}

TEST(ThreadsUnderSanitizer, ShareBallsWithoutARace) {
  expect_one_trace(sized("gas", 200, 0.8), test_laws());
}

TEST(ThreadsUnderSanitizer, ShareManyTerritoriesWithoutARace) {
  const scene::Scene scene = sized("gas", 200, 0.8);
  engines::RunOptions many;
  many.faults.regions = 7;
  EXPECT_EQ(difference(run_on(1, scene, test_laws(), {}), run_on(2, scene, test_laws(), many)), "");
}

TEST(ThreadsUnderSanitizer, ShareTumblingSolidsWithoutARace) {
  expect_one_trace(sized("atoms", 90, 0.4), test_laws());
}

TEST(ThreadsUnderSanitizer, ShareProcessesInContactWithoutARace) {
  expect_one_trace(sized("avalanche", 60, 0.6), reference_laws());
}

TEST(ThreadsUnderSanitizer, ShareLinkedProcessesWithoutARace) {
  expect_one_trace(sized("cars", 12, 0.2), reference_laws());
}

TEST(ThreadsUnderSanitizer, ShareAGroupThatFusesAndSplitsWithoutARace) {
  expect_one_trace(tower_and_projectile(5.0), reference_laws());
}

TEST(ThreadsUnderSanitizer, ShareArmsAndWhatTheyThrowWithoutARace) {
  expect_one_trace(sized("robots", 3, 0.1), reference_laws());
}

TEST(ThreadsUnderSanitizer, ShareRodsDragAndForcesWithoutARace) {
  expect_one_trace(pendula_and_balls(8, 0.6), reference_laws());
}

// Of all balls at once, twice; and of processes: what they have done beyond is taken back across
// regions.
TEST(ThreadsUnderSanitizer, AreCalledBackWithoutARace) {
  const scene::Scene gas = sized("gas", 150, 0.8);
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(gas.bodies.size()); ++i)
    if (!gas.bodies[static_cast<std::size_t>(i)].immovable) all.push_back(i);
  const auto push = [](int body, RigidBodyState& state) {
    state.momentum_world += Vector3d(0.1, 0.02 * (body % 5), -0.1);
  };
  expect_one_trace(gas, test_laws(), {{{0.21, all, push}, {0.5017, all, push}}});
  expect_one_trace(pendula_and_balls(6, 0.6), reference_laws(),
                   {{{0.25, {0, 1, 4}, push}, {0.25, {2, 7}, push}}});
}

TEST(ThreadsUnderSanitizer, KeepACapOfStatesWithoutARace) {
  expect_one_trace(sized("gas", 150, 0.8), test_laws(), {{}, 8});
  expect_one_trace(sized("avalanche", 24, 0.4), reference_laws(), {{}, 8});
}

// Rows that collide at one instant, cut by regions.
TEST(ThreadsUnderSanitizer, ShareTiesWithoutARace) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 5; ++j)
      bodies.push_back(ball("ball" + std::to_string(5 * i + j), 0.0625, 1.0,
                            {0.25 * i, 0.25 * j, 0},
                            {i % 4 == 0   ? 0.5
                             : i % 4 == 2 ? -0.5
                                          : 0.0,
                             0, 0}));
  expect_one_trace(scene_of(std::move(bodies), 1.0), test_laws());
}

}  // namespace
}  // namespace tumble::testing
