// The energy scale of a scene's checks, which must not include energy that the judged run itself
// created.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/engines/judging/judge.h"

namespace tumble::engines {
namespace {

Frame frame_of(double time, double kinetic, double potential) {
  Frame frame;
  frame.time = time;
  frame.kinetic_energy = kinetic;
  frame.potential_energy = potential;
  return frame;
}

CheckResult judged(const std::string& kind, double tolerance, std::vector<Frame> frames,
                   double at_s = 0.0) {
  scene::Scene scene;
  scene::CheckSpec check;
  check.kind = kind;
  check.tolerance = tolerance;
  check.at_s = at_s;
  scene.checks = {check};
  Trajectory run;
  run.frames = std::move(frames);
  return judge_run(scene, run).at(0);
}

TEST(EnergyChecks, RunThatGainsEnergyDoesNotWidenItsOwnTolerance) {
  // From 1 J to 1000 J: relative to its largest energy 999 / 1000, relative to the initial energy
  // 999.
  for (const char* kind : {"energy", "energy_not_rising"}) {
    const CheckResult result = judged(kind, 1.0, {frame_of(0, 1, 0), frame_of(1, 1000, 0)});
    // minus the rounding of the largest terms, about 1e-15 of them
    EXPECT_NEAR(result.value, 999.0, 999.0 * 1e-13) << kind;
    EXPECT_FALSE(result.passed) << kind;
  }
}

TEST(EnergyChecks, RunThatRisesWithoutSlowingDownDoesNotEither) {
  EXPECT_DOUBLE_EQ(
      judged("energy", 1.0, {frame_of(0, 1, 0), frame_of(1, 1, 50), frame_of(2, 1, 500)}).value,
      500.0);
}

TEST(EnergyChecks, FallFromRestIsMeasuredByItsDepth) {
  // 10 J of potential energy become 9.9 J of kinetic energy: 1 %.
  EXPECT_NEAR(judged("energy", 0.02, {frame_of(0, 0, 30), frame_of(1, 9.9, 20)}).value, 0.01,
              1e-15);
  EXPECT_TRUE(judged("energy", 0.02, {frame_of(0, 0, 30), frame_of(1, 9.9, 20)}).passed);
}

TEST(EnergyChecks, AfterAForceTheScaleStartsAtTheEndOfTheForce) {
  const std::vector<Frame> pushed = {frame_of(0, 0, 0), frame_of(1, 100, 0), frame_of(2, 101, 0)};
  EXPECT_NEAR(judged("energy", 0.02, pushed, 1.0).value, 0.01, 1e-15);
}

TEST(EnergyChecks, NanIsNeverRight) {
  EXPECT_FALSE(judged("energy", 1.0, {frame_of(0, std::nan(""), 0), frame_of(1, 1, 0)}).passed);
  EXPECT_FALSE(judged("energy", 1.0, {frame_of(0, 1, 0), frame_of(1, std::nan(""), 0)}).passed);
}

}  // namespace
}  // namespace tumble::engines
