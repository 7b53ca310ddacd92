// Timewarp on several threads commits what the reference commits, to the last bit, whatever the threads' timing.
#include <gtest/gtest.h>

#include "tests/engines/event_scenes.h"

namespace tumble::testing {
namespace {

Trajectory run_on(int threads, const scene::Scene& scene, const engines::TimewarpTrial& trial = {}, double frame_rate_hz = 60.0) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.trial = trial;
  options.threads = threads;
  options.frame_rate_hz = frame_rate_hz;
  engines::run_scene(scene, test_laws(), options, recorder);
  return recorder.trajectory();
}

// Test 1 of the table.
TEST(Threads, CommitTheReferencesTraceOfAtoms) {
  const scene::Scene scene = sized("atoms", 300, 10.0);
  const Trajectory reference = run_by("ordered", scene, {}, 5.0);
  ASSERT_GT(reference.events.size(), 3000U);
  for (const int threads : {1, 2, 4, 8}) EXPECT_EQ(difference(reference, run_on(threads, scene, {}, 5.0)), "") << threads << " threads";
}

}  // namespace
}  // namespace tumble::testing
