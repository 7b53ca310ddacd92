// Timewarp on several threads commits the reference's trace, to the last bit, whatever the threads'
// timing; and it keeps its limits.
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/engines/base/guarded_laws.h"
#include "tests/engines/event_scenes.h"
#include "tests/engines/late_row.h"

namespace tumble::testing {
namespace {

struct Threads {
  int count = 1;
  engines::FaultInjection faults{};
  int most_states = 0;
};

Trajectory run_on(const Threads& threads, const scene::Scene& scene, double frame_rate_hz = 60.0,
                  const Laws& laws = test_laws()) {
  engines::RunOptions options;
  options.engine = "tw";
  options.faults = threads.faults;
  options.threads = threads.count;
  options.most_states = threads.most_states;
  options.frame_rate_hz = frame_rate_hz;
  return run_as_told(std::move(options), scene, laws);
}

engines::FaultInjection delayed(std::uint64_t seed, double delay_s, double disorder_s = 0.0) {
  engines::FaultInjection faults;
  faults.seed = seed;
  faults.delay_s = delay_s;
  faults.disorder_s = disorder_s;
  faults.shuffle = true;
  return faults;
}

TEST(Threads, CommitTheReferencesTraceOfAtoms) {
  const scene::Scene scene = sized("atoms", 300, 10.0);
  const Trajectory reference = run_by("ordered", scene, {}, 5.0);
  ASSERT_GT(reference.events.size(), 3000U);
  for (const int threads : {1, 2, 4, 8}) {
    const Trajectory run = run_on({threads}, scene, 5.0);
    EXPECT_EQ(difference(reference, run), "") << threads << " threads";
    EXPECT_LE(100 * run.counters.counts.at("undone_integrations"),
              15 * run.counters.counts.at("integrations"))
        << threads << " threads";
  }
}

// For very many bodies there are more regions than threads; here for few bodies, so that most of
// them are at a boundary.
TEST(Threads, WithSeveralRegionsEachCommitTheReferencesTrace) {
  for (const auto& [scene, duration] : {std::pair{"gas", 3.0}, {"atoms", 2.0}}) {
    const scene::Scene cut = sized(scene, 200, duration);
    const Trajectory reference = run_by("ordered", cut, {}, 5.0);
    ASSERT_GT(reference.events.size(), 300U) << scene;
    for (const int threads : {1, 2, 3}) {
      engines::FaultInjection faults;
      faults.regions = 7;  // not a multiple of the threads: one has more of them
      const Trajectory run = run_on({threads, faults}, cut, 5.0);
      EXPECT_EQ(difference(reference, run), "") << scene << ", " << threads << " threads";
      EXPECT_GE(run.counters.counts.at("rounds_of_threads"), 10U) << scene;
      EXPECT_LE(100 * run.counters.counts.at("undone_integrations"),
                15 * run.counters.counts.at("integrations"))
          << scene << ", " << threads << " threads";
    }
  }
}

// From 12,000 bodies on, one thread uses regions by default. The reference would check 7 * 10^7
// pairs: conservative advancement replaces it, which has no regions and commits the reference's
// trace (timewarp_test); over a longer time the same run in one region.
TEST(Threads, OneUsesSeveralRegionsByItselfForVeryManyBodies) {
  constexpr int kBodies = 12'600;
  const scene::Scene brief = sized("gas", kBodies, 0.2);
  const Trajectory advanced = run_by("ca", brief, {}, 10.0);
  ASSERT_GT(advanced.events.size(), 3000U);
  const Trajectory by_itself = run_on({1}, brief, 10.0);
  EXPECT_EQ(difference(advanced, by_itself), "");
  EXPECT_GE(by_itself.counters.counts.at("rounds_of_threads"), 5U);

  const scene::Scene longer = sized("gas", kBodies, 0.8);
  engines::FaultInjection one_region;
  one_region.regions = 1;
  const Trajectory in_order = run_on({1, one_region}, longer, 10.0);
  EXPECT_EQ(in_order.counters.counts.at("rounds_of_threads"), 0U);
  for (const int threads : {1, 2}) {
    const Trajectory run = run_on({threads}, longer, 10.0);
    EXPECT_EQ(difference(in_order, run), "") << threads << " threads";
    // speculation across boundaries was wrong, and rolled back
    EXPECT_GT(run.counters.counts.at("anti_messages"), 0U) << threads << " threads";
  }
}

// While it exists, the system gives a few threads more and no others: the stack of each takes a
// quarter of the address space that is left.
class FewThreads {
 public:
  FewThreads() {
    constexpr std::size_t kStack = std::size_t{256} << 20;  // bytes
    ::pthread_getattr_default_np(&before_);
    pthread_attr_t large;
    ::pthread_getattr_default_np(&large);
    ::pthread_attr_setstacksize(&large, kStack);
    ::pthread_setattr_default_np(&large);
    ::pthread_attr_destroy(&large);
    ::getrlimit(RLIMIT_AS, &limit_before_);
    std::size_t pages = 0;  // of this process's address space
    std::ifstream("/proc/self/statm") >> pages;
    rlimit limit = limit_before_;
    limit.rlim_cur = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + 4 * kStack;
    is_limited_ = ::setrlimit(RLIMIT_AS, &limit) == 0;
  }
  ~FewThreads() {
    ::setrlimit(RLIMIT_AS, &limit_before_);
    ::pthread_setattr_default_np(&before_);
    ::pthread_attr_destroy(&before_);
  }
  FewThreads(const FewThreads&) = delete;
  FewThreads& operator=(const FewThreads&) = delete;
  bool is_limited() const { return is_limited_; }

 private:
  pthread_attr_t before_{};
  rlimit limit_before_{};
  bool is_limited_ = false;
};

TEST(Threads, MoreThanTheSystemGivesAreRefusedWithTheNumberThatItGives) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs the address space";
#endif
  const scene::Scene scene = sized("gas", 60, 0.1);
  const FewThreads few;
  ASSERT_TRUE(few.is_limited());
  try {
    run_on({16}, scene);
    FAIL() << "16 threads were given";
  } catch (const UserError& error) {
    EXPECT_EQ(error.where(), "--threads 16");
    EXPECT_TRUE(error.problem().starts_with("the system gives only ")) << error.problem();
  }
}

// 200 seeds: random choice among the legal events of a thread, and random delays.
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
  EXPECT_GT(rollbacks, 200U * 2);  // the random choices were hard enough
  EXPECT_GT(rounds, 200U * 3);     // and threads ran concurrently
}

// Counters too: a thread's view does not depend on the speed of the others.
TEST(Threads, CountTheSameHoweverTheyAreDelayed) {
  for (const auto& [scene, threads] : {std::pair{"gas", 2}, {"gas", 4}, {"atoms", 2}}) {
    const scene::Scene cut = sized(scene, 200, 1.0);
    const Trajectory plain = run_on({threads}, cut);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      engines::FaultInjection faults = delayed(seed, 50e-6);
      faults.shuffle = false;
      EXPECT_EQ(run_on({threads, faults}, cut).counters.counts, plain.counters.counts)
          << scene << ", " << threads << " threads, seed " << seed;
    }
  }
}

// A second pass with territories across those of the first takes what crosses these: with one cut
// alone a tenth and more of a gas of this size is left to one thread.
TEST(Threads, LeaveToOneAloneOnlyWhatCrossesBothCuts) {
  const scene::Scene scene = sized("gas", 400, 5.0);
  const Trajectory run = run_on({2}, scene);
  const double impacts = static_cast<double>(run.counters.counts.at("impacts")),
               at_home = static_cast<double>(run.counters.counts.at("impacts_at_home"));
  ASSERT_GT(impacts, 1000.0);
  EXPECT_GT(at_home, 0.95 * impacts);
}

// Two bodies that hit each other repeatedly, in two regions; a ball at each far end keeps both
// threads busy. Only a cut between the two ends meets one body or none.
scene::Scene echo() {
  std::vector<scene::BodySpec> bodies{plane("left", {-2, 0, 0}, {1, 0, 0}),
                                      plane("right", {2, 0, 0}, {-1, 0, 0})};
  bodies.push_back(ball("a", 0.1, 1.0, {-0.5, 0, 0}, {1.0, 0, 0}));
  bodies.push_back(ball("b", 0.1, 1.0, {0.5, 0, 0}, {-1.0, 0, 0}));
  bodies.push_back(ball("c", 0.1, 1.0, {-1.5, 1, 0}, {0.7, 0, 0}));
  bodies.push_back(ball("d", 0.1, 1.0, {1.5, -1, 0}, {-0.9, 0, 0}));
  return scene_of(bodies, 200.0);
}

TEST(Echo, OfTwoBodiesUndoesNoMoreThanItCommits) {
  const scene::Scene scene = echo();
  const Trajectory reference = run_by("ordered", scene, {}, 0.5);
  ASSERT_GT(reference.events.size(), 200U);
  const auto of_the_two =
      std::count_if(reference.events.begin(), reference.events.end(),
                    [](const Event& event) { return event.body_a == 2 && event.body_b == 3; });
  ASSERT_GT(of_the_two, 50);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Trajectory run = run_on({2, delayed(seed, 1e-4)}, scene, 0.5);
    EXPECT_EQ(difference(reference, run), "") << "seed " << seed;
    const std::uint64_t undone = run.counters.counts.at("undone_integrations"),
                        all = run.counters.counts.at("integrations");
    EXPECT_LE(undone, all - undone) << "seed " << seed;
    // Each thread owns one of the two bodies: most of their impacts cross regions, and both threads
    // have work in their own.
    EXPECT_GT(2 * run.counters.counts.at("impacts_across_territories"),
              static_cast<std::uint64_t>(of_the_two))
        << "seed " << seed;
    EXPECT_GT(run.counters.counts.at("least_events_of_a_thread"), 50U) << "seed " << seed;
    // the ratio is not of zeros,
    EXPECT_GT(undone, 0U) << "seed " << seed;
    // and threads ran concurrently all the time
    EXPECT_GT(run.counters.counts.at("rounds_of_threads"), 100U) << "seed " << seed;
  }
}

// Many microsteps: rows that collide at once, cut by regions.
TEST(Threads, ExecuteTiesAcrossRegionsInTheirOrder) {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 5; ++j)
      bodies.push_back(ball("ball" + std::to_string(5 * i + j), 0.0625, 1.0,
                            {0.25 * i, 0.25 * j, 0},
                            {i % 4 == 0   ? 0.5
                             : i % 4 == 2 ? -0.5
                                          : 0.0,
                             0, 0}));
  const scene::Scene scene = scene_of(std::move(bodies), 2.0);
  const Trajectory reference = run_by("ordered", scene, {}, 5.0);
  ASSERT_GT(reference.events.size(), 150U);
  for (const int threads : {2, 3, 8})
    EXPECT_EQ(difference(reference, run_on({threads}, scene, 5.0)), "") << threads << " threads";
}

TEST(Threads, StopWhereTheReferenceStops) {
  Laws laws = test_laws();
  laws.collision_impulse = [law = laws.collision_impulse](const Contact& contact, const Body& a,
                                                          const Body& b, double restitution) {
    const double impulse = law(contact, a, b, restitution);
    return impulse > 2.5 ? kUnset : impulse;  // N s: the first strong impact
  };
  const scene::Scene scene = sized("gas", 100, 2.0);
  const Trajectory reference = run_by("ordered", scene, {}, 60.0, laws);
  ASSERT_NE(reference.stopped_by, "");
  for (const int threads : {1, 2, 4})
    EXPECT_EQ(difference(reference, run_on({threads}, scene, 60.0, laws)), "")
        << threads << " threads";
}

// The limit is reported once, to the calling thread: a thread that took it for a consequence of its
// own speculation would run to the end.
TEST(Threads, StopWhenTimeIsUpWhereverTheyAre) {
  const scene::Scene scene = sized("gas", 200, 2.0);
  const Trajectory reference = run_by("ordered", scene, {}, 30.0);
  for (const int threads : {1, 2})
    for (const int last : {100, 300, 700}) {
      std::atomic<int> asked = 0;
      Laws laws = test_laws();
      laws.relative_normal_velocity = [&asked, last, law = laws.relative_normal_velocity](
                                          const Contact& contact, const Body& a, const Body& b) {
        if (++asked == last) throw engines::OutOfTime("it takes more than 1 s");
        return law(contact, a, b);
      };
      engines::FaultInjection faults;
      faults.regions = 4;
      const Trajectory run = run_on({threads, faults}, scene, 30.0, laws);
      EXPECT_EQ(run.stopped_by.find("it takes more than 1 s"), 0U)
          << threads << " threads, " << last << ": " << run.stopped_by;
      // the other thread finishes its epoch
      EXPECT_LT(asked, last + 200) << threads << " threads";
      ASSERT_LT(run.events.size(), reference.events.size());
      // what was committed was certain
      for (std::size_t k = 0; k < run.events.size(); ++k)
        ASSERT_EQ(run.events[k].time, reference.events[k].time)
            << threads << " threads, event " << k;
    }
}

TEST(Threads, AreRefusedInWordsWhereTheirNumberMakesNoSense) {
  EXPECT_THROW(run_on({0}, sized("gas", 4, 0.1)), UserError);
  EXPECT_THROW(run_on({1000}, sized("gas", 4, 0.1)), UserError);
  EXPECT_THROW(run_on({1, {}, 3}, sized("gas", 4, 0.1)), UserError);
  engines::FaultInjection faults;
  for (const int regions : {-1, 256, 1000}) {  // 256 in a byte is the boundary
    faults.regions = regions;
    try {
      run_on({1, faults}, sized("gas", 4, 0.1));
      FAIL() << regions;
    } catch (const PreconditionError& error) {
      EXPECT_NE(std::string(error.what()).find("FaultInjection::regions"), std::string::npos)
          << error.what();
    }
  }
  faults.regions = 255;
  EXPECT_EQ(run_on({1, faults}, sized("gas", 40, 0.1)).stopped_by, "");
}

// ---- Bounds ------------------------------------------------------------------------------------

// A random order far ahead of global virtual time keeps many states, unless there is a limit.
TEST(CapOfStates, OfEightIsKeptAndChangesNothing) {
  const scene::Scene scene = sized("gas", 40, 20.0);
  const Trajectory reference = run_by("ordered", scene, {}, 1.0);
  engines::FaultInjection hard;
  hard.disorder_s = 10.0;
  const Trajectory free = run_on({1, hard}, scene, 1.0), capped = run_on({1, hard, 8}, scene, 1.0),
                   threaded = run_on({2, {}, 8}, scene, 1.0);
  EXPECT_EQ(difference(reference, free), "");
  EXPECT_EQ(difference(reference, capped), "");
  EXPECT_EQ(difference(reference, threaded), "");
  EXPECT_GT(free.counters.counts.at("most_states_of_a_body"), 8U);
  EXPECT_GT(capped.counters.counts.at("held_back"), 0U);
  EXPECT_LE(capped.counters.counts.at("most_states_of_a_body"), 8U);
  EXPECT_LE(threaded.counters.counts.at("most_states_of_a_body"), 8U);
}

// After 20 seconds and after 100: the largest number of states does not grow.
TEST(Memory, OfAGasStaysFlat) {
  for (const int threads : {1, 2}) {
    const auto kept = [&](double duration) {
      return run_on({threads}, sized("gas", 400, duration), 1.0).counters.counts.at("states_kept");
    };
    const std::uint64_t short_run = kept(20.0), long_run = kept(100.0);
    EXPECT_LE(20 * long_run, 21 * short_run) << threads << " threads";  // 5 %
  }
}

// One ball between two blocks, 10,000 bounces per second, and 12,600 others that hardly move: one
// thread uses regions here, and an epoch ends before any body has very many events in it, so that
// no more is kept for any duration.
TEST(Memory, OfABusyBodyAmongVeryManyStaysFlat) {
  constexpr int kBodies = 12'600;
  for (const double duration : {0.5, 1.0}) {
    scene::Scene scene = sized("gas", kBodies, duration);
    // without walls
    std::erase_if(scene.bodies, [](const scene::BodySpec& body) {
      return body.immovable || !body.name.starts_with("ball_");
    });
    for (scene::BodySpec& body : scene.bodies) body.velocity_m_s *= 1e-3;
    for (const double x : {-0.7, 0.7}) {
      scene.bodies.push_back(
          box(x < 0 ? "left" : "right", {0.5, 1, 1}, 1.0, {x, 500, 500}, Vector3d::Zero()));
      scene.bodies.back().immovable = true;
      scene.bodies.back().mass_kg.reset();
    }
    scene.bodies.push_back(ball("busy", 0.1, 1.0, {0, 500, 500}, {2000, 0, 0}));
    const Trajectory run = run_on({1}, scene, 1.0);
    ASSERT_EQ(run.events.size(), static_cast<std::size_t>(10'000 * duration));
    EXPECT_GT(run.counters.counts.at("rounds_of_threads"), 10U);
    EXPECT_LE(run.counters.counts.at("most_states_of_a_body"), 300U) << duration << " s";
    // otherwise: a quarter of the events of the run
    EXPECT_LE(run.counters.counts.at("states_kept"), kBodies + 300U) << duration << " s";
    engines::FaultInjection one_region;
    one_region.regions = 1;
    EXPECT_EQ(difference(run_on({1, one_region}, scene, 1.0), run), "") << duration << " s";
  }
}

// ---- A late event at the first of a row --------------------------------------------------------

// Work is counted; its CPU time is measured by bench_engines --only "late event".
TEST(LateEvent, AtTheFirstOfARowRollsEachBackOnceInWorkLinearInTheirNumber) {
  std::map<int, double> work;
  for (const int n : {10, 100, 1000, 100'000}) {
    const Trajectory run = taken_back_row(n);
    ASSERT_EQ(run.stopped_by, "") << n;
    ASSERT_EQ(run.events.size(), 1U) << n;
    EXPECT_EQ(run.events[0].kind, EventKind::kControl) << n;
    EXPECT_EQ(run.counters.counts.at("rollbacks"), static_cast<std::uint64_t>(n)) << n;
    EXPECT_GE(run.counters.counts.at("anti_messages"), static_cast<std::uint64_t>(n - 1)) << n;
    for (const char* what : {"integrations", "undone_integrations", "pair_checks"})
      work[n] += static_cast<double>(run.counters.counts.at(what));
  }
  EXPECT_NEAR(std::log10(work[1000] / work[100]), 1.0, 0.1);
  EXPECT_NEAR(0.5 * std::log10(work[100'000] / work[1000]), 1.0, 0.1);
}

// ---- Energy ------------------------------------------------------------------------------------

TEST(RunawayEnergy, StopsEveryEventEngineAndNamesBodyTimeAndLaws) {
  Laws laws = test_laws();
  laws.collision_impulse = [law = laws.collision_impulse](const Contact& contact, const Body& a,
                                                          const Body& b, double restitution) {
    return 1.6 * law(contact, a, b, restitution);
  };
  const scene::Scene scene = sized("gas", 30, 20.0);
  for (const char* engine : {"ordered", "ca", "tw"}) {
    const Trajectory run = run_by(engine, scene, {}, 10.0, laws);
    for (const char* word :
         {"at t = ", "body 'ball_", "runaway energy", "comes from collision (collision_impulse"})
      EXPECT_NE(run.stopped_by.find(word), std::string::npos) << engine << ": " << run.stopped_by;
    ASSERT_GT(run.frames.size(), 1U) << engine;
    EXPECT_LT(run.frames.back().time, 20.0) << engine;
    EXPECT_GT(run.events.size(), 10U) << engine;  // the recording is kept
  }
  EXPECT_EQ(run_by("tw", sized("gas", 30, 2.0), {}, 10.0).stopped_by, "");
}

}  // namespace
}  // namespace tumble::testing
