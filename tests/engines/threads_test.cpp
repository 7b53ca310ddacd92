// Timewarp on several threads commits what the reference commits, to the last bit, whatever the threads' timing; and it keeps its bounds.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/engines/base/guarded_laws.h"
#include "tests/engines/event_scenes.h"

namespace tumble::testing {
namespace {

struct Threads {
  int count = 1;
  engines::TimewarpTrial trial{};
  int most_states = 0;
};

Trajectory run_on(const Threads& threads, const scene::Scene& scene, double frame_rate_hz = 60.0, const Laws& laws = test_laws()) {
  engines::RunOptions options;
  options.engine = "tw";
  options.trial = threads.trial;
  options.threads = threads.count;
  options.most_states = threads.most_states;
  options.frame_rate_hz = frame_rate_hz;
  return run_as_told(std::move(options), scene, laws);
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

// Room is cut finer than threads are many where there are very many bodies; here where there are few, so that most of them come to a border.
TEST(Threads, WithSeveralTerritoriesEachCommitTheReferencesTrace) {
  for (const auto& [scene, duration] : {std::pair{"gas", 3.0}, {"atoms", 2.0}}) {
    const scene::Scene cut = sized(scene, 200, duration);
    const Trajectory reference = run_by("ordered", cut, {}, 5.0);
    ASSERT_GT(reference.events.size(), 300U) << scene;
    for (const int threads : {1, 2, 3}) {
      engines::TimewarpTrial trial;
      trial.territories = 7;   // no multiple of the threads: one has more of them
      const Trajectory run = run_on({threads, trial}, cut, 5.0);
      EXPECT_EQ(difference(reference, run), "") << scene << ", " << threads << " threads";
      EXPECT_GE(run.counters.counts.at("rounds_of_threads"), 10U) << scene;
      EXPECT_LE(100 * run.counters.counts.at("undone_integrations"), 15 * run.counters.counts.at("integrations")) << scene << ", " << threads << " threads";
    }
  }
}

// From 12,000 bodies on one thread, too, goes by territories, and nobody asks it to. The reference would look at 7 * 10^7 pairs: conservative advancement
// stands for it, which knows no territories and commits what the reference does (timewarp_test); over a longer time the same run in one territory.
TEST(Threads, OneGoesByTerritoriesByItselfWhereBodiesAreMany) {
  constexpr int kBodies = 12'600;
  const scene::Scene brief = sized("gas", kBodies, 0.2);
  const Trajectory advanced = run_by("ca", brief, {}, 10.0);
  ASSERT_GT(advanced.events.size(), 3000U);
  const Trajectory by_itself = run_on({1}, brief, 10.0);
  EXPECT_EQ(difference(advanced, by_itself), "");
  EXPECT_GE(by_itself.counters.counts.at("rounds_of_threads"), 5U);

  const scene::Scene longer = sized("gas", kBodies, 0.8);
  engines::TimewarpTrial one_territory;
  one_territory.territories = 1;
  const Trajectory in_order = run_on({1, one_territory}, longer, 10.0);
  EXPECT_EQ(in_order.counters.counts.at("rounds_of_threads"), 0U);
  for (const int threads : {1, 2}) {
    const Trajectory run = run_on({threads}, longer, 10.0);
    EXPECT_EQ(difference(in_order, run), "") << threads << " threads";
    EXPECT_GT(run.counters.counts.at("anti_messages"), 0U) << threads << " threads";   // across borders somebody was wrong, and it was taken back
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
  const auto of_the_two = std::count_if(reference.events.begin(), reference.events.end(), [](const Event& event) { return event.body_a == 2 && event.body_b == 3; });
  ASSERT_GT(of_the_two, 50);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Trajectory run = run_on({2, delayed(seed, 1e-4)}, scene, 0.5);
    EXPECT_EQ(difference(reference, run), "") << "seed " << seed;
    const std::uint64_t undone = run.counters.counts.at("undone_integrations"), all = run.counters.counts.at("integrations");
    EXPECT_LE(undone, all - undone) << "seed " << seed;
    // Each thread has its own of the two bodies: most of their impacts are of two territories, and both threads have work at home.
    EXPECT_GT(2 * run.counters.counts.at("impacts_across_territories"), static_cast<std::uint64_t>(of_the_two)) << "seed " << seed;
    EXPECT_GT(run.counters.counts.at("least_events_of_a_thread"), 50U) << "seed " << seed;
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
  for (const int threads : {1, 2, 4}) EXPECT_EQ(difference(reference, run_on({threads}, scene, 60.0, laws)), "") << threads << " threads";
}

// Said once, to whoever asks just then: a thread that took it for a consequence of its own guesses would go on to the end.
TEST(Threads, StopWhenTimeIsUpWhereverTheyAre) {
  const scene::Scene scene = sized("gas", 200, 2.0);
  const Trajectory reference = run_by("ordered", scene, {}, 30.0);
  for (const int threads : {1, 2})
    for (const int last : {100, 300, 700}) {
      std::atomic<int> asked = 0;
      Laws laws = test_laws();
      laws.relative_normal_velocity = [&asked, last, law = laws.relative_normal_velocity](const Contact& contact, const Body& a, const Body& b) {
        if (++asked == last) throw engines::OutOfTime("it takes more than 1 s");
        return law(contact, a, b);
      };
      engines::TimewarpTrial trial;
      trial.territories = 4;
      const Trajectory run = run_on({threads, trial}, scene, 30.0, laws);
      EXPECT_EQ(run.stopped_by.find("it takes more than 1 s"), 0U) << threads << " threads, " << last << ": " << run.stopped_by;
      EXPECT_LT(asked, last + 200) << threads << " threads";   // the other thread comes to the end of its round
      ASSERT_LT(run.events.size(), reference.events.size());
      for (std::size_t k = 0; k < run.events.size(); ++k) ASSERT_EQ(run.events[k].time, reference.events[k].time) << threads << " threads, event " << k;   // what is told was certain
    }
}

TEST(Threads, AreRefusedInWordsWhereTheirNumberMakesNoSense) {
  EXPECT_THROW(run_on({0}, sized("gas", 4, 0.1)), UserError);
  EXPECT_THROW(run_on({1000}, sized("gas", 4, 0.1)), UserError);
  EXPECT_THROW(run_on({1, {}, 3}, sized("gas", 4, 0.1)), UserError);
  engines::TimewarpTrial trial;
  for (const int territories : {-1, 256, 1000}) {   // 256 in a byte is the border
    trial.territories = territories;
    try {
      run_on({1, trial}, sized("gas", 4, 0.1));
      FAIL() << territories;
    } catch (const PreconditionError& error) {
      EXPECT_NE(std::string(error.what()).find("TimewarpTrial::territories"), std::string::npos) << error.what();
    }
  }
  trial.territories = 255;
  EXPECT_EQ(run_on({1, trial}, sized("gas", 40, 0.1)).stopped_by, "");
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

// One ball to and fro between two blocks, 10,000 times a second, and 12,600 others that hardly move: on one thread, which goes by territories here, a
// round ends before anybody has done very much in it, so that no more is kept however long it goes on.
TEST(Memory, OfABusyBodyAmongVeryManyStaysFlat) {
  constexpr int kBodies = 12'600;
  for (const double duration : {0.5, 1.0}) {
    scene::Scene scene = sized("gas", kBodies, duration);
    std::erase_if(scene.bodies, [](const scene::BodySpec& body) { return body.immovable || !body.name.starts_with("ball_"); });   // without walls
    for (scene::BodySpec& body : scene.bodies) body.velocity_m_s *= 1e-3;
    for (const double x : {-0.7, 0.7}) {
      scene.bodies.push_back(box(x < 0 ? "left" : "right", {0.5, 1, 1}, 1.0, {x, 500, 500}, Vector3d::Zero()));
      scene.bodies.back().immovable = true;
      scene.bodies.back().mass_kg.reset();
    }
    scene.bodies.push_back(ball("busy", 0.1, 1.0, {0, 500, 500}, {2000, 0, 0}));
    const Trajectory run = run_on({1}, scene, 1.0);
    ASSERT_EQ(run.events.size(), static_cast<std::size_t>(10'000 * duration));
    EXPECT_GT(run.counters.counts.at("rounds_of_threads"), 10U);
    EXPECT_LE(run.counters.counts.at("most_states_of_a_body"), 300U) << duration << " s";
    EXPECT_LE(run.counters.counts.at("states_kept"), kBodies + 300U) << duration << " s";   // without: a quarter of the events of the run
    engines::TimewarpTrial one_territory;
    one_territory.territories = 1;
    EXPECT_EQ(difference(run_on({1, one_territory}, scene, 1.0), run), "") << duration << " s";
  }
}

// ---- A late event at the first of a row ----------------------------------------------------------------------------------

// A ball hits the next one, that one the next, and so on; when the last has been hit, the first turns out to have been turned back before
// it began. Nothing of it has happened.
Trajectory taken_back_row(int n, double duration = kUnset) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < n; ++i) bodies.push_back(ball("ball" + std::to_string(i), 0.1, 1.0, {0.25 * i, 0, 0}, Vector3d::Zero()));
  bodies[0].velocity_m_s.x() = 1.0;
  engines::RunOptions options;
  options.engine = "tw";
  options.trial.late_callbacks = true;
  options.frame_rate_hz = 1e-6;
  options.callbacks = {{0.01, {0}, [](int, RigidBodyState& state) { state.momentum_world.x() = -1.0; }}};
  if (std::isnan(duration)) duration = 0.05 * n + 0.1;
  if (duration < options.callbacks.front().time) options.callbacks.clear();
  return run_as_told(std::move(options), scene_of(std::move(bodies), duration), test_laws());
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

/// CPU time that a row takes beyond what it takes to set it up, the least of several runs. [s]
double seconds_of_row(int n) {
  double run = 1e9, building = 1e9, all = 0.0;
  for (int k = 0; k < 40 && (k < 5 || all < 0.5); ++k) {
    double began = cpu_seconds();
    taken_back_row(n, 1e-9);
    building = std::min(building, cpu_seconds() - began);
    began = cpu_seconds();
    taken_back_row(n);
    run = std::min(run, cpu_seconds() - began);
    all += run;
  }
  return run - building;
}

// Least squares through the logarithms: a tenth off is a factor of 1.6 over the two decades, which a neighbour on the machine does not make.
TEST(LateEvent, AtTheFirstOfARowTakesCpuTimeLinearInTheirNumber) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const std::vector<int> sizes{10, 32, 100, 316, 1000};
  for (const int n : sizes) {
    const double at = std::log10(n), seconds = seconds_of_row(n), log_s = std::log10(seconds);
    ASSERT_GT(seconds, 0.0) << n;
    RecordProperty("microseconds_of_" + std::to_string(n), std::to_string(1e6 * seconds));
    x += at, y += log_s, xx += at * at, xy += at * log_s;
  }
  const double count = static_cast<double>(sizes.size());
  EXPECT_NEAR((count * xy - x * y) / (count * xx - x * x), 1.0, 0.1);
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
