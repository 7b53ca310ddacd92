// Timewarp on several threads commits what the reference commits, to the last bit, whatever the threads' timing; and it keeps its bounds.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "tests/engines/event_scenes.h"

namespace tumble::testing {
namespace {

struct Threads {
  int count = 1;
  engines::TimewarpTrial trial{};
  int most_states = 0;
};

Trajectory run_on(const Threads& threads, const scene::Scene& scene, double frame_rate_hz = 60.0) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.trial = threads.trial;
  options.threads = threads.count;
  options.most_states = threads.most_states;
  options.frame_rate_hz = frame_rate_hz;
  engines::run_scene(scene, test_laws(), options, recorder);
  return recorder.trajectory();
}

engines::TimewarpTrial delayed(std::uint64_t seed, double delay_s, double disorder_s = 0.0) {
  engines::TimewarpTrial trial;
  trial.seed = seed;
  trial.delay_s = delay_s;
  trial.disorder_s = disorder_s;
  trial.shuffle = true;
  return trial;
}

TEST(Threads, CommitTheReferencesTraceOfAtoms) {
  const scene::Scene scene = sized("atoms", 300, 10.0);
  const Trajectory reference = run_by("ordered", scene, {}, 5.0);
  ASSERT_GT(reference.events.size(), 3000U);
  for (const int threads : {1, 2, 4, 8}) {
    const Trajectory run = run_on({threads}, scene, 5.0);
    EXPECT_EQ(difference(reference, run), "") << threads << " threads";
    EXPECT_LE(100 * run.counters.counts.at("undone_integrations"), 15 * run.counters.counts.at("integrations")) << threads << " threads";
  }
}

// 200 seeds: which legal event a thread takes, and when it is held up.
TEST(Threads, InAdversarialOrderAndDelayedLeaveTheTraceAsItIs) {
  const scene::Scene scene = sized("gas", 60, 1.0);
  const Trajectory reference = run_by("ordered", scene);
  ASSERT_GT(reference.events.size(), 80U);
  std::uint64_t rollbacks = 0, rounds = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Trajectory run = run_on({seed % 3 == 0 ? 4 : 2, delayed(seed, 20e-6, 0.1)}, scene);
    ASSERT_EQ(difference(reference, run), "") << "seed " << seed;
    rollbacks += run.counters.counts.at("rollbacks");
    rounds += run.counters.counts.at("rounds_of_threads");
  }
  EXPECT_GT(rollbacks, 200U * 2);   // the lot was hard enough
  EXPECT_GT(rounds, 200U * 3);      // and threads worked side by side
}

// Counters too: what a thread sees does not depend on how fast the others are.
TEST(Threads, CountTheSameHoweverTheyAreDelayed) {
  const scene::Scene scene = sized("gas", 200, 1.0);
  const Trajectory plain = run_on({2}, scene);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    engines::TimewarpTrial trial = delayed(seed, 50e-6);
    trial.shuffle = false;
    EXPECT_EQ(run_on({2, trial}, scene).counters.counts, plain.counters.counts) << "seed " << seed;
  }
}

// Two bodies that hit each other again and again, at home in two territories; a ball each at the far ends keeps both threads busy.
scene::Scene echo() {
  std::vector<scene::BodySpec> bodies{plane("left", {-2, 0, 0}, {1, 0, 0}), plane("right", {2, 0, 0}, {-1, 0, 0})};
  bodies.push_back(ball("a", 0.1, 1.0, {-0.5, 0, 0}, {1.0, 0, 0}));
  bodies.push_back(ball("b", 0.1, 1.0, {0.5, 0, 0}, {-1.0, 0, 0}));
  bodies.push_back(ball("c", 0.1, 1.0, {-1.5, 1, 0}, {0.7, 0, 0}));
  bodies.push_back(ball("d", 0.1, 1.0, {1.5, 1, 0}, {-0.9, 0, 0}));
  return scene_of(bodies, 200.0);
}

TEST(Echo, OfTwoBodiesUndoesNoMoreThanItCommits) {
  const scene::Scene scene = echo();
  const Trajectory reference = run_by("ordered", scene, {}, 0.5);
  ASSERT_GT(reference.events.size(), 200U);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Trajectory run = run_on({2, delayed(seed, 1e-4)}, scene, 0.5);
    EXPECT_EQ(difference(reference, run), "") << "seed " << seed;
    const std::uint64_t undone = run.counters.counts.at("undone_integrations"), all = run.counters.counts.at("integrations");
    EXPECT_LE(undone, all - undone) << "seed " << seed;
    EXPECT_GT(undone, 0U) << "seed " << seed;                                          // the ratio is of something,
    EXPECT_GT(run.counters.counts.at("rounds_of_threads"), 100U) << "seed " << seed;   // and threads worked side by side all the time
  }
}

// A billiard of generations: rows that collide at once, cut by territories.
TEST(Threads, TakeTiesAcrossTerritoriesInTheirOrder) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 5; ++j) bodies.push_back(ball("ball" + std::to_string(5 * i + j), 0.0625, 1.0, {0.25 * i, 0.25 * j, 0}, {i % 4 == 0 ? 0.5 : i % 4 == 2 ? -0.5 : 0.0, 0, 0}));
  const scene::Scene scene = scene_of(std::move(bodies), 2.0);
  const Trajectory reference = run_by("ordered", scene, {}, 5.0);
  ASSERT_GT(reference.events.size(), 150U);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(difference(reference, run_on({threads}, scene, 5.0)), "") << threads << " threads";
}

TEST(Threads, StopWhereTheReferenceStops) {
  Laws laws = test_laws();
  laws.collision_impulse = [law = laws.collision_impulse](const Contact& contact, const Body& a, const Body& b, double restitution) {
    const double impulse = law(contact, a, b, restitution);
    return impulse > 2.5 ? kUnset : impulse;   // N s: the first hard blow
  };
  const scene::Scene scene = sized("gas", 100, 2.0);
  const Trajectory reference = run_by("ordered", scene, {}, 60.0, laws);
  ASSERT_NE(reference.stopped_by, "");
  for (const int threads : {1, 2, 4}) {
    TrajectoryRecorder recorder;
    engines::RunOptions options;
    options.engine = "tw";
    options.timewarp = engines::fast_timewarp();
    options.threads = threads;
    engines::run_scene(scene, laws, options, recorder);
    EXPECT_EQ(difference(reference, recorder.trajectory()), "") << threads << " threads";
  }
}

TEST(Threads, AreRefusedInWordsWhereTheirNumberMakesNoSense) {
  EXPECT_THROW(run_on({0}, sized("gas", 4, 0.1)), UserError);
  EXPECT_THROW(run_on({1000}, sized("gas", 4, 0.1)), UserError);
  EXPECT_THROW(run_on({1, {}, 3}, sized("gas", 4, 0.1)), UserError);
}

// ---- Bounds ----------------------------------------------------------------------------------------------------------------

// An order by lot far ahead of global virtual time keeps many states, unless there is a cap.
TEST(CapOfStates, OfEightIsKeptAndChangesNothing) {
  const scene::Scene scene = sized("gas", 40, 20.0);
  const Trajectory reference = run_by("ordered", scene, {}, 1.0);
  engines::TimewarpTrial hard;
  hard.disorder_s = 10.0;
  const Trajectory free = run_on({1, hard}, scene, 1.0), capped = run_on({1, hard, 8}, scene, 1.0), threaded = run_on({2, {}, 8}, scene, 1.0);
  EXPECT_EQ(difference(reference, free), "");
  EXPECT_EQ(difference(reference, capped), "");
  EXPECT_EQ(difference(reference, threaded), "");
  EXPECT_GT(free.counters.counts.at("most_states_of_a_body"), 8U);
  EXPECT_GT(capped.counters.counts.at("held_back"), 0U);
  EXPECT_LE(capped.counters.counts.at("most_states_of_a_body"), 8U);
  EXPECT_LE(threaded.counters.counts.at("most_states_of_a_body"), 8U);
}

// After 20 seconds and after 100: what is kept at most does not grow.
TEST(Memory, OfAGasStaysFlat) {
  for (const int threads : {1, 2}) {
    const auto kept = [&](double duration) { return run_on({threads}, sized("gas", 400, duration), 1.0).counters.counts.at("states_kept"); };
    const std::uint64_t short_run = kept(20.0), long_run = kept(100.0);
    EXPECT_LE(20 * long_run, 21 * short_run) << threads << " threads";   // 5 %
  }
}

// ---- A late event at the first of a row ----------------------------------------------------------------------------------

// A ball hits the next one, that one the next, and so on; when the last has been hit, the first turns out to have been turned back before
// it began. Nothing of it has happened.
Trajectory taken_back_row(int n) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < n; ++i) bodies.push_back(ball("ball" + std::to_string(i), 0.1, 1.0, {0.25 * i, 0, 0}, Vector3d::Zero()));
  bodies[0].velocity_m_s.x() = 1.0;
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.trial.late_callbacks = true;
  options.frame_rate_hz = 1e-6;
  options.callbacks = {{0.01, {0}, [](int, RigidBodyState& state) { state.momentum_world.x() = -1.0; }}};
  engines::run_scene(scene_of(std::move(bodies), 0.05 * n + 0.1), test_laws(), options, recorder);
  return recorder.trajectory();
}

TEST(LateEvent, AtTheFirstOfARowRollsEachBackOnceInTimeLinearInTheirNumber) {
  std::map<int, double> work;
  for (const int n : {10, 100, 1000, 100'000}) {
    const Trajectory run = taken_back_row(n);
    ASSERT_EQ(run.stopped_by, "") << n;
    ASSERT_EQ(run.events.size(), 1U) << n;
    EXPECT_EQ(run.events[0].kind, EventKind::kControl) << n;
    EXPECT_EQ(run.counters.counts.at("rollbacks"), static_cast<std::uint64_t>(n)) << n;
    EXPECT_GE(run.counters.counts.at("anti_messages"), static_cast<std::uint64_t>(n - 1)) << n;
    for (const char* what : {"integrations", "undone_integrations", "pair_checks"}) work[n] += static_cast<double>(run.counters.counts.at(what));
  }
  EXPECT_NEAR(std::log10(work[1000] / work[100]), 1.0, 0.1);
  EXPECT_NEAR(0.5 * std::log10(work[100'000] / work[1000]), 1.0, 0.1);
}

// ---- Energy ----------------------------------------------------------------------------------------------------------------

TEST(RunawayEnergy, StopsEveryEventEngineAndNamesBodyTimeAndLaws) {
  Laws laws = test_laws();
  laws.collision_impulse = [law = laws.collision_impulse](const Contact& contact, const Body& a, const Body& b, double restitution) { return 1.6 * law(contact, a, b, restitution); };
  const scene::Scene scene = sized("gas", 30, 20.0);
  for (const char* engine : {"ordered", "ca", "tw"}) {
    const Trajectory run = run_by(engine, scene, {}, 10.0, laws);
    for (const char* word : {"at t = ", "body 'ball_", "runaway energy", "comes from collision (collision_impulse"}) EXPECT_NE(run.stopped_by.find(word), std::string::npos) << engine << ": " << run.stopped_by;
    ASSERT_GT(run.frames.size(), 1U) << engine;
    EXPECT_LT(run.frames.back().time, 20.0) << engine;
    EXPECT_GT(run.events.size(), 10U) << engine;   // the recording is kept
  }
  EXPECT_EQ(run_by("tw", sized("gas", 30, 2.0), {}, 10.0).stopped_by, "");
}

}  // namespace
}  // namespace tumble::testing
