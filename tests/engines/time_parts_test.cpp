// The parts of an engine's time: their names are names of functions, and the parts of each engine
// add up to the whole.
#include <gtest/gtest.h>

#include "framework/engines/rd/recorder.h"
#include "framework/engines/run.h"
#include "framework/engines/judging/time_parts.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

constexpr double kRounding = 1e-12;  // a sum of eight shares

// A renamed function would silently count as scheduling.
TEST(TimeParts, AreNamesOfFunctions) {
  const Laws laws = reference_laws();  // their functions are among the parts
  for (const StackSamples::Part& part : engines::time_parts())
    for (const std::string& name : part.functions)
      EXPECT_TRUE(StackSamples::is_known(name))
          << part.name << ": no function begins with " << name;
  for (const std::string& name : engines::set_up_functions())
    EXPECT_TRUE(StackSamples::is_known(name)) << name;
}

// The cost of a robot's arm is its rods, joints and the block in its scoop, and no decision of an
// engine.
TEST(TimeParts, OfRobotsArePhysicsByEveryEngine) {
  // A run is some ten samples, of which 7 in 10 or fewer are physics one time in 14 even where the
  // share is 0.9; of 60, less than once in 10,000.
  constexpr int kRuns = 12;
  constexpr std::size_t kFewest = 60;
  const scene::Scene scene = scene::make_sized_scene("robots", 1);
  const Laws laws = reference_laws();
  for (const char* engine : {"rd", "ca", "tw"}) {
    engines::RunOptions options;
    options.engine = engine;
    options.timewarp = engines::fast_timewarp();
    options.duration_s = 0.3;
    StackSamples samples;
    samples.begin();
    for (int run = 0; run < kRuns; ++run) {
      TrajectoryRecorder recorder;
      engines::run_scene(scene, laws, options, recorder);
    }
    samples.end();
    const engines::TimeShares shares = engines::time_shares(samples);
    if (shares.samples < kFewest) GTEST_SKIP() << "too quick to tell";
    double sum = 0.0;
    for (const auto& [name, share] : shares.parts) sum += share;
    EXPECT_NEAR(sum, 1.0, kRounding) << engine;
    EXPECT_GT(shares.physics, 0.7) << engine << ": " << engines::in_words(shares);
  }
}

}  // namespace
}  // namespace tumble::testing
