// What the energy checks of a scene compare with: never with energy that the judged run made itself.
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

CheckResult judged(const std::string& kind, double tolerance, std::vector<Frame> frames, double at_s = 0.0) {
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

TEST(EnergyChecks, ARunThatGainsEnergyDoesNotWidenItsOwnPassMark) {
  // From 1 J to 1000 J: over its own largest 999 / 1000, over what it began with 999.
  for (const char* kind : {"energy", "energy_not_rising"}) {
    const CheckResult result = judged(kind, 1.0, {frame_of(0, 1, 0), frame_of(1, 1000, 0)});
    EXPECT_NEAR(result.value, 999.0, 999.0 * 1e-13) << kind;   // less what rounding of the largest terms explains: some 1e-15 of them
    EXPECT_FALSE(result.passed) << kind;
  }
}

TEST(EnergyChecks, ARunThatRisesWithoutSlowingDownDoesNotEither) {
  EXPECT_DOUBLE_EQ(judged("energy", 1.0, {frame_of(0, 1, 0), frame_of(1, 1, 50), frame_of(2, 1, 500)}).value, 500.0);
}

TEST(EnergyChecks, AFallFromRestIsMeasuredByItsDepth) {
  // 10 J fallen, 9.9 J found: 1 per cent.
  EXPECT_NEAR(judged("energy", 0.02, {frame_of(0, 0, 30), frame_of(1, 9.9, 20)}).value, 0.01, 1e-15);
  EXPECT_TRUE(judged("energy", 0.02, {frame_of(0, 0, 30), frame_of(1, 9.9, 20)}).passed);
}

TEST(EnergyChecks, AfterAPushTheBeginningIsWhereThePushEnded) {
  const std::vector<Frame> pushed = {frame_of(0, 0, 0), frame_of(1, 100, 0), frame_of(2, 101, 0)};
  EXPECT_NEAR(judged("energy", 0.02, pushed, 1.0).value, 0.01, 1e-15);
}

TEST(EnergyChecks, NoNumberIsNeverRight) {
  EXPECT_FALSE(judged("energy", 1.0, {frame_of(0, std::nan(""), 0), frame_of(1, 1, 0)}).passed);
  EXPECT_FALSE(judged("energy", 1.0, {frame_of(0, 1, 0), frame_of(1, std::nan(""), 0)}).passed);
}

}  // namespace
}  // namespace tumble::engines
