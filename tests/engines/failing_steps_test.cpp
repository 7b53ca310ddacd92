// A step that fails ahead of global virtual time stops nothing, unless it is reached: then every
// engine stops there, with the same words.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/engines/base/tolerances.h"
#include "tests/engines/event_scenes.h"
#include "tests/engines/failing_steps.h"

namespace tumble::testing::failing_steps_test {
namespace {

struct Told {
  std::string engine = "tw";
  int threads = 1;
  engines::FaultInjection faults{};
  int most_states = 0;
};

Trajectory run_told(const Told& told, const scene::Scene& scene,
                    const Laws& laws = with_failing_steps(test_laws())) {
  engines::RunOptions options;
  options.engine = told.engine;
  options.threads = told.threads;
  options.faults = told.faults;
  options.most_states = told.most_states;
  return run_as_told(std::move(options), scene, laws);
}

engines::FaultInjection by_lot(std::uint64_t seed) {
  engines::FaultInjection faults;
  faults.seed = seed;
  faults.shuffle = true;
  faults.disorder_s = 0.05;
  faults.rollback_every = 7;
  faults.rollback_s = 0.02;
  return faults;
}

// What `ordered` does, in any order of execution.
void expect_the_reference_everywhere(const scene::Scene& scene, const Trajectory& reference,
                                     const Laws& laws = with_failing_steps(test_laws())) {
  const auto difference_of = [&](const Told& told) {
    return difference(reference, run_told(told, scene, laws));
  };
  EXPECT_EQ(difference_of({"ca"}), "");
  for (const int threads : {1, 2, 3})
    EXPECT_EQ(difference_of({"tw", threads}), "") << threads << " threads";
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    EXPECT_EQ(difference_of({"tw", 1, by_lot(seed)}), "") << "seed " << seed;
  engines::FaultInjection cut;
  cut.regions = 3;
  EXPECT_EQ(difference_of({"tw", 1, cut}), "") << "three regions";
  for (const int threads : {1, 2})
    EXPECT_EQ(difference_of({"tw", threads, {}, 8}), "") << "eight states, " << threads;
}

// Timewarp takes up to eight steps of an island at once, and every engine one step beyond where it
// looks, so that these impacts are found after the step at 0.5 s has failed.
TEST(FailingStep, ThatAnImpactPreventsStopsNothing) {
  for (const double met_at : {0.39, 0.41, 0.43, 0.45, 0.47, 0.49}) {
    SCOPED_TRACE(met_at);
    const scene::Scene scene = pushed_carts(1, met_at, 1.0);
    const Trajectory reference = run_told({"ordered"}, scene);
    ASSERT_EQ(reference.stopped_by, "");
    ASSERT_EQ(collision_times(reference).size(), 1U);
    EXPECT_NEAR(collision_times(reference).front(), met_at, 1e-9);
    expect_the_reference_everywhere(scene, reference);
    // All bodies step together there: the same run but for roundings and the root's bracket, which
    // are below 1e-9 m. A cart that was not turned back would be 1 m away.
    const Trajectory together = run_told({"rd"}, scene);
    ASSERT_EQ(together.stopped_by, "");
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
      EXPECT_LT(
          (together.frames.back().poses[i].com_world - reference.frames.back().poses[i].com_world)
              .norm(),
          1e-6)
          << scene.bodies[i].name;
  }
}

// With 60 frames a second, 30 of them lie before 0.5 s, and one at 0.5 s: nothing is left to happen
// at that instant but the step.
TEST(FailingStep, ThatIsReachedStopsEveryEngineAtItsStart) {
  const scene::Scene scene = pushed_carts(1, 0.7, 1.0);
  const Trajectory reference = run_told({"ordered"}, scene);
  for (const char* word : {"at t = 0.500000 s", "cart0", "no way through"})
    EXPECT_NE(reference.stopped_by.find(word), std::string::npos) << reference.stopped_by;
  EXPECT_EQ(reference.frames.size(), 31U);
  EXPECT_EQ(reference.frames.back().time, kCartFails);
  const Trajectory together = run_told({"rd"}, scene);
  EXPECT_NE(together.stopped_by, "");
  EXPECT_EQ(together.frames.size(), reference.frames.size());
  EXPECT_EQ(collision_times(reference).size(), 0U);
  expect_the_reference_everywhere(scene, reference);
}

// Seven frames a second, and one that is asked for a rounding after the step fails.
TEST(FailingStep, HasTheFrameOfItsInstantHoweverThatIsRounded) {
  const scene::Scene scene = pushed_carts(1, 0.7, 1.0);
  const auto run_with_instant = [&](const Told& told) {
    engines::RunOptions options;
    options.engine = told.engine;
    options.threads = told.threads;
    options.frame_rate_hz = 7.0;
    options.instants_s = {kCartFails + 1e-12};
    return run_as_told(std::move(options), scene, with_failing_steps(test_laws()));
  };
  for (const Told& told : {Told{"rd"}, Told{"ordered"}, Told{"ca"}, Told{"tw", 1}, Told{"tw", 2}}) {
    SCOPED_TRACE(told.engine + ", " + std::to_string(told.threads) + " threads");
    const Trajectory run = run_with_instant(told);
    ASSERT_EQ(run.frames.size(), 5U);  // at 0, 1/7, 2/7, 3/7 and 1/2 s
    EXPECT_NEAR(run.frames.back().time, kCartFails, 2e-12);
  }
}

// The first cart would fail at 0.5 s, the second at 0.75 s, the third at 1 s.
TEST(FailingStep, OfSeveralTheFirstThatNothingPreventsCounts) {
  for (const auto& [met_at, fault] : {std::pair{0.46, "at t = 0.750000 s, body 'cart1'"},
                                      std::pair{0.6, "at t = 0.500000 s, body 'cart0'"}}) {
    SCOPED_TRACE(met_at);
    const scene::Scene scene = pushed_carts(3, met_at, 1.5);
    const Trajectory reference = run_told({"ordered"}, scene);
    EXPECT_EQ(reference.stopped_by.find(fault), 0U) << reference.stopped_by;
    expect_the_reference_everywhere(scene, reference);
  }
}

// A size depends on the state that the function is called with, so an impact may prevent a wrong
// one, too.
TEST(FailingStep, OfAWrongSizeIsLikeAnyOther) {
  const Laws laws = with_steps_of_a_wrong_size(test_laws());
  for (const double met_at : {0.43, 0.47, 0.7}) {
    SCOPED_TRACE(met_at);
    const scene::Scene scene = pushed_carts(1, met_at, 1.0);
    const Trajectory reference = run_told({"ordered"}, scene, laws);
    const std::string stop = "at t = 0.500000 s, body 'cart0'";
    EXPECT_EQ(reference.stopped_by.substr(0, stop.size()), met_at < kCartFails ? "" : stop);
    expect_the_reference_everywhere(scene, reference, laws);
  }
}

// The step before the impact stands: frames within it are recorded, and the time is the impact's.
TEST(FailingStep, AtItsImpactIsKnownUpToThere) {
  const Laws laws = with_failing_responses(test_laws());
  const scene::Scene scene = cart_and_post(0.5125, std::nullopt);  // 0.8 of the step from 0.5 s
  const auto run_with_instants = [&](const std::string& engine) {
    engines::RunOptions options;
    options.engine = engine;
    options.instants_s = {0.505, 0.51};
    return run_as_told(std::move(options), scene, laws);
  };
  const Trajectory reference = run_with_instants("ordered"), together = run_with_instants("rd");
  for (const char* word : {"at t = 0.512500 s", "cart0", "no way back"})
    for (const Trajectory* run : {&reference, &together})
      EXPECT_NE(run->stopped_by.find(word), std::string::npos) << run->stopped_by;
  // 31 up to 0.5 s, and the two instants
  EXPECT_EQ(reference.frames.size(), 33U);
  EXPECT_EQ(together.frames.size(), reference.frames.size());
  EXPECT_EQ(reference.frames.back().time, 0.51);
  for (const char* engine : {"ca", "tw"})
    EXPECT_EQ(difference(reference, run_with_instants(engine)), "") << engine;
  expect_the_reference_everywhere(scene, run_told({"ordered"}, scene, laws), laws);
}

// A frame at the very instant of the impact would show what is after it, and nothing is.
TEST(FailingStep, AtItsImpactHasNoFrameThere) {
  const Laws failing = with_failing_responses(test_laws());
  Laws responding = failing;
  responding.collision_impulse = test_laws().collision_impulse;
  const scene::Scene scene = cart_and_post(0.5125, std::nullopt);
  for (const Told& told : {Told{"rd"}, Told{"ordered"}, Told{"ca"}, Told{"tw", 1}, Told{"tw", 2}}) {
    SCOPED_TRACE(told.engine + ", " + std::to_string(told.threads) + " threads");
    const std::vector<double> met_at = collision_times(run_told(told, scene, responding));
    ASSERT_GE(met_at.size(), 1U);
    engines::RunOptions options;
    options.engine = told.engine;
    options.threads = told.threads;
    options.instants_s = {met_at.front()};
    const Trajectory run = run_as_told(std::move(options), scene, failing);
    EXPECT_NE(run.stopped_by.find("no way back"), std::string::npos) << run.stopped_by;
    EXPECT_EQ(run.frames.size(), 31U);  // up to 0.5 s
  }
}

// At 0.3 of the same step the cart meets a pebble: it never comes to the post.
TEST(FailingStep, WhoseImpactAnEarlierOneInTheStepPreventsStopsNothing) {
  const Laws laws = with_failing_responses(test_laws());
  const scene::Scene scene = cart_and_post(0.5125, 0.5046875);
  const Trajectory reference = run_told({"ordered"}, scene, laws);
  ASSERT_EQ(reference.stopped_by, "");
  EXPECT_EQ(collision_times(reference).size(), 1U);
  expect_the_reference_everywhere(scene, reference, laws);
  EXPECT_EQ(run_told({"rd"}, scene, laws).stopped_by, "");
}

// A program that acts at the very instant turns the cart back before its step begins.
TEST(FailingStep, ThatACallbackOfItsInstantPreventsStopsNothing) {
  const scene::Scene scene = pushed_carts(1, 5.0, 1.0);
  const auto run_with_callback = [&](const Told& told) {
    engines::RunOptions options;
    options.engine = told.engine;
    options.threads = told.threads;
    options.faults = told.faults;
    options.callbacks = {
        {kCartFails, {0}, [](int, RigidBodyState& state) { state.momentum_world.x() = -1.0; }}};
    return run_as_told(std::move(options), scene, with_failing_steps(test_laws()));
  };
  const Trajectory reference = run_with_callback({"ordered"});
  ASSERT_EQ(reference.stopped_by, "");
  engines::FaultInjection late;
  late.late_callbacks = true;
  for (const Told& told : {Told{"ca"}, Told{"tw", 1}, Told{"tw", 2}, Told{"tw", 1, late}})
    EXPECT_EQ(difference(reference, run_with_callback(told)), "")
        << told.engine << ", " << told.threads << " threads";
}

// ---- What steps that never count have noted ----------------------------------------------------

TEST(Faults, OfStepsThatAnImpactPreventsAreNone) {
  const Laws laws = with_spinning_steps(test_laws());
  for (const double met_at : {0.39, 0.43, 0.47, 0.49}) {
    SCOPED_TRACE(met_at);
    const scene::Scene scene = pushed_cube(met_at, 1.0);
    const Trajectory reference = run_told({"ordered"}, scene, laws);
    ASSERT_EQ(reference.stopped_by, "");
    ASSERT_EQ(collision_times(reference).size(), 1U);
    EXPECT_EQ(faults_of(reference), "");
    expect_the_reference_everywhere(scene, reference, laws);
    EXPECT_EQ(faults_of(run_told({"rd"}, scene, laws)).find("turn"), std::string::npos);
  }
}

// The steps at 33, 34 and 35 / 64 s turn too far; none is taken from 36 / 64 s.
TEST(Faults, OfTheStepsUpToAFailureAllCount) {
  const Laws laws = with_spinning_steps(test_laws());
  const scene::Scene scene = pushed_cube(0.75, 1.0);
  const Trajectory reference = run_told({"ordered"}, scene, laws);
  EXPECT_EQ(reference.stopped_by.find("at t = 0.562500 s"), 0U) << reference.stopped_by;
  ASSERT_EQ(reference.counters.faults.size(), 1U);
  EXPECT_EQ(reference.counters.faults[0].kind, "turn_unresolved");
  EXPECT_EQ(reference.counters.faults[0].count, 3U);
  EXPECT_EQ(reference.counters.faults[0].first_s, 33.0 / 64.0);
  expect_the_reference_everywhere(scene, reference, laws);
}

// A cube that turns 4 rad in each of 64 steps, most of which are dropped before the run ends: their
// notes count as they are.
TEST(Faults, OfStepsThatAreNoLongerKeptAllCount) {
  scene::Scene scene = pushed_cube(5.0, 1.0);
  scene.bodies[0].omega_world_rad_s = {255.0, 0.0, 0.0};
  const Trajectory reference = run_told({"ordered"}, scene, test_laws());
  ASSERT_EQ(reference.stopped_by, "");
  ASSERT_EQ(reference.counters.faults.size(), 1U) << faults_of(reference);
  EXPECT_EQ(reference.counters.faults[0].kind, "turn_unresolved");
  EXPECT_EQ(reference.counters.faults[0].count, 64U);
  EXPECT_EQ(reference.counters.faults[0].first_s, 0.0);
  expect_the_reference_everywhere(scene, reference, test_laws());
}

// The run ends where the first of them would begin; and within it, which counts.
TEST(Faults, OfAStepBeyondTheEndOfTheRunAreNone) {
  const Laws laws = with_spinning_steps(test_laws());
  for (const auto& [duration, count] : {std::pair{33.0 / 64.0, 0U}, {33.5 / 64.0, 1U}}) {
    SCOPED_TRACE(duration);
    const scene::Scene scene = pushed_cube(0.75, duration);
    const Trajectory reference = run_told({"ordered"}, scene, laws);
    ASSERT_EQ(reference.stopped_by, "");
    EXPECT_EQ(reference.counters.faults.size(), count) << faults_of(reference);
    expect_the_reference_everywhere(scene, reference, laws);
  }
}

std::size_t notices_of_turning(const Trajectory& run) {
  const std::vector<std::string>& notices = run.counters.notices;
  return static_cast<std::size_t>(std::count_if(
      notices.begin(), notices.end(),
      [](const std::string& notice) { return notice.find("half a turn") != std::string::npos; }));
}

// A cart that is a ball looks the same however it turns: that is a notice and no fault, and counts
// where its steps do.
TEST(Notices, OfStepsThatAnImpactPreventsAreNone) {
  const Laws laws = with_spinning_steps(test_laws());
  for (const auto& [met_at, count] : {std::pair{0.43, 0U}, {0.47, 0U}, {0.49, 0U}, {0.75, 1U}}) {
    SCOPED_TRACE(met_at);
    const scene::Scene scene = beside_much_energy(pushed_carts(1, met_at, 1.0));
    for (const Told& told : {Told{"ordered"}, Told{"ca"}, Told{"tw", 1}, Told{"tw", 2},
                             Told{"tw", 1, by_lot(1)}, Told{"tw", 1, by_lot(2)}}) {
      const Trajectory run = run_told(told, scene, laws);
      EXPECT_EQ(notices_of_turning(run), count)
          << told.engine << ", " << told.threads << " threads, seed " << told.faults.seed;
      EXPECT_EQ(faults_of(run), "");
    }
  }
}

// A multiple of the step may lie a rounding before the end: no engine takes a step from there.
TEST(FailingStep, AtTheEndOfTheRunOrBeyondStopsNothing) {
  // in half the step, so that what counts as a rounding is subtracted again without one: the step
  // that fails begins at the first instant that counts as the end
  const double half_a_step = 0.5 * kFailingStep, rounding = engines::kNegligible * half_a_step;
  ASSERT_EQ(kCartFails + rounding - rounding, kCartFails);
  for (const double duration :
       {kCartFails, std::nextafter(kCartFails, 1.0), kCartFails + rounding, 0.505}) {
    scene::Scene scene = pushed_carts(1, 5.0, duration);
    if (duration == kCartFails + rounding) scene.step_s = half_a_step;
    if (duration > 0.501) scene.step_s = duration - 1e-12;  // one step, and 1e-12 s
    for (const Told& told :
         {Told{"rd"}, Told{"ordered"}, Told{"ca"}, Told{"tw", 1}, Told{"tw", 2}}) {
      SCOPED_TRACE(told.engine + ", " + std::to_string(told.threads) + " threads");
      const Trajectory run = run_told(told, scene);
      EXPECT_EQ(run.stopped_by, "");
      EXPECT_EQ(run.frames.back().time, duration);
    }
  }
}

}  // namespace
}  // namespace tumble::testing::failing_steps_test
