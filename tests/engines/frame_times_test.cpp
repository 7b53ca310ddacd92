// When frames are recorded: at multiples of the frame time, at the instants that are asked for
// beside them, and at the end, whatever the duration is.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "framework/engines/base/frame_times.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/run.h"
#include "tests/engines/event_scenes.h"

namespace tumble::testing::frame_times_test {
namespace {

std::vector<double> all(engines::FrameTimes times) {
  std::vector<double> found;
  for (; std::isfinite(times.next()); times.take()) found.push_back(times.next());
  return found;
}

TEST(FrameTimes, AreMultiplesAndTheEnd) {
  EXPECT_EQ(all({4.0, 1.0}), (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  EXPECT_EQ(all({4.0, 1.1}), (std::vector<double>{0, 0.25, 0.5, 0.75, 1, 1.1}));
  EXPECT_EQ(all({60.0, 1e-5}), (std::vector<double>{0, 1e-5})) << "shorter than a frame";
  EXPECT_EQ(all({1e-6, 2.0}), (std::vector<double>{0, 2})) << "a rate that asks for none";
}

TEST(FrameTimes, HaveTheInstantsThatAreAskedForOnce) {
  EXPECT_EQ(all({4.0, 1.0, {0.6, 0.1, 0.6, 0.5, 0, 1, 7, -1}}),
            (std::vector<double>{0, 0.1, 0.25, 0.5, 0.6, 0.75, 1}));
  EXPECT_EQ(all({10.0, 0.4, {0.1 + 1e-12, 0.2 - 1e-12, 0.4 - 1e-12}}),
            (std::vector<double>{0, 0.1, 0.2, 3 / 10.0, 0.4}))
      << "rounding makes no instant of its own";
  EXPECT_EQ(all({3.0, 1.0, {0.333333, 1e-9}}), (std::vector<double>{0, 1 / 3.0, 2 / 3.0, 1}))
      << "nor do six decimals";
  EXPECT_EQ(all({60.0, 1e-6, {5e-7}}), (std::vector<double>{0, 5e-7, 1e-6}))
      << "which are much in a run of microseconds";
}

TEST(FrameTimes, AscendAndMissNothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-6, 6), share(-0.1, 1.1);
  for (int trial = 0; trial < 2000; ++trial) {
    const double duration = std::pow(10.0, exponent(random)),
                 rate = std::pow(10.0, std::uniform_real_distribution<double>(-3, 2)(random)) /
                        duration;
    std::vector<double> instants;
    for (int k = 0; k < trial % 5; ++k) instants.push_back(share(random) * duration);
    const std::vector<double> times = all({rate, duration, instants});
    ASSERT_EQ(times.front(), 0.0);
    ASSERT_EQ(times.back(), duration);
    for (std::size_t k = 1; k < times.size(); ++k) ASSERT_LT(times[k - 1], times[k]);
    const auto has = [&](double t) {
      return std::any_of(times.begin(), times.end(), [&](double time) {
        return std::abs(time - t) <=
               std::min(1e-6, 1e-3 * std::min(1.0 / rate, duration)) * (1 + 1e-9);
      });
    };
    for (const double instant : instants) {
      if (!(instant > 0.0) || instant >= duration) continue;
      ASSERT_TRUE(has(instant)) << instant;
    }
    for (long k = 0; static_cast<double>(k) / rate < duration; ++k)
      ASSERT_TRUE(has(static_cast<double>(k) / rate)) << k;
  }
}

// A free fall is known at every instant: z = -g t^2 / 2.
TEST(FrameTimes, LetChecksSeeTheEndAndWhatLiesBetweenFrames) {
  for (const double duration : {1.01, 0.505, 1e-5})
    for (const char* engine : {"rd", "ordered", "ca", "tw"}) {
      scene::Scene scene = scene_of({ball("ball", 0.1, 1.0, Vector3d::Zero(), Vector3d::Zero())},
                                    duration, Vector3d(0, 0, -9.81));
      scene.step_s = duration / 7;
      for (const double at : {0.0, duration / 3}) {
        scene::CheckSpec check;
        check.kind = "final_position";
        check.body = "ball";
        check.at_s = at;
        const double t = at == 0.0 ? duration : at;
        check.expected = {0, 0, -0.5 * 9.81 * t * t};
        check.tolerance = 1e-13 * t * t + 1e-16;  // rounding of a closed form or of RK4's sums
        scene.checks.push_back(check);
      }
      engines::RunOptions options;
      options.engine = engine;
      options.instants_s = engines::instants_of_checks(scene);
      for (const engines::CheckResult& result :
           engines::judge_run(scene, run_as_told(options, scene, test_laws())))
        EXPECT_TRUE(result.passed) << engine << ", " << duration << " s: " << result.detail;
    }
}

}  // namespace
}  // namespace tumble::testing::frame_times_test
