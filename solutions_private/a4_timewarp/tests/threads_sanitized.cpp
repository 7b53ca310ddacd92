// The fast scheduler under ThreadSanitizer: its own sources, and the framework's that its threads share, are compiled with it.
#include <gtest/gtest.h>

#include "tests/engines/event_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

Trajectory run_on(int threads, const scene::Scene& scene, const Laws& laws, int territories = 0) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.threads = threads;
  options.trial.territories = territories;
  options.trial.delay_s = 20e-6;
  options.trial.seed = static_cast<std::uint64_t>(threads);
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

// A race ends the program with an exit code of its own, whatever the traces say.
void expect_one_trace(const scene::Scene& scene, const Laws& laws) {
  const Trajectory one = run_on(1, scene, laws);
  for (const int threads : {2, 4}) {
    const Trajectory run = run_on(threads, scene, laws);
    EXPECT_EQ(difference(one, run), "") << threads << " threads";
    EXPECT_GE(run.counters.counts.at("rounds_of_threads"), 3U) << threads << " threads";
  }
}

TEST(ThreadsUnderSanitizer, ShareBallsWithoutARace) { expect_one_trace(sized("gas", 200, 0.8), test_laws()); }

TEST(ThreadsUnderSanitizer, ShareManyTerritoriesWithoutARace) {
  const scene::Scene scene = sized("gas", 200, 0.8);
  EXPECT_EQ(difference(run_on(1, scene, test_laws()), run_on(2, scene, test_laws(), 7)), "");
}

TEST(ThreadsUnderSanitizer, ShareTumblingSolidsWithoutARace) { expect_one_trace(sized("atoms", 90, 0.4), test_laws()); }

TEST(ThreadsUnderSanitizer, ShareProcessesInContactWithoutARace) { expect_one_trace(sized("avalanche", 60, 0.6), reference_laws()); }

TEST(ThreadsUnderSanitizer, ShareLinkedProcessesWithoutARace) { expect_one_trace(sized("cars", 12, 0.2), reference_laws()); }

}  // namespace
}  // namespace tumble::testing
