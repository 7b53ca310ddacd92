// Where contacts with friction begin to slide and to stick is told once, when it happens.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/engines/reference_laws.h"

namespace tumble::testing::contact_modes_test {
namespace {

constexpr double kG = 9.81;

scene::BodySpec rough(scene::BodySpec body, double friction) {
  body.friction = friction;
  body.restitution = 0.0;
  return body;
}

scene::Scene with_contact(std::vector<scene::BodySpec> bodies, double duration) {
  scene::Scene scene = scene_of(std::move(bodies), duration, Vector3d(0, 0, -kG));
  scene.contact.emplace();
  return scene;
}

scene::BodySpec floor_of(double friction) {
  return rough(plane("floor", Vector3d::Zero(), Vector3d::UnitZ()), friction);
}
scene::BodySpec sliding_block(double friction, double speed) {
  return rough(box("block", {0.2, 0.2, 0.1}, 1.0, {0, 0, 0.1}, {speed, 0, 0}), friction);
}

std::vector<Event> changes_of(const Trajectory& run) {
  std::vector<Event> changes;
  for (const Event& event : run.events)
    if (event.kind == EventKind::kSlide || event.kind == EventKind::kStick)
      changes.push_back(event);
  return changes;
}

std::vector<Event> changes_in(const scene::Scene& scene) {
  const Trajectory result = run(scene, reference_laws());
  EXPECT_EQ(result.stopped_by, "");
  return changes_of(result);
}

TEST(ContactModes, ABlockSlidesUntilItSticks) {
  const auto changes = changes_in(with_contact({sliding_block(0.5, 2.0), floor_of(0.5)}, 1.0));
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].kind, EventKind::kSlide);
  EXPECT_EQ(changes[0].time, 0.0);
  EXPECT_EQ(changes[0].body_a, 0);
  EXPECT_EQ(changes[0].body_b, 1);
  EXPECT_EQ(changes[1].kind, EventKind::kStick);
  // v / (mu g): forces are constant, the end of sliding is located
  EXPECT_NEAR(changes[1].time, 2.0 / (0.5 * kG), 1e-9);
}

TEST(ContactModes, ABallSticksWhereItBeginsToRoll) {
  const auto changes = changes_in(with_contact(
      {rough(ball("ball", 0.2, 1.0, {0, 0, 0.2}, {3.5, 0, 0}), 0.3), floor_of(0.3)}, 1.0));
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[1].kind, EventKind::kStick);
  EXPECT_NEAR(changes[1].time, 1.0 / (0.3 * kG), 1e-9);  // (2/7) v / (mu g)
}

TEST(ContactModes, AContactThatKeepsItsModeReportsNothing) {
  // sticks from the beginning
  EXPECT_EQ(changes_in(with_contact({sliding_block(0.5, 0.0), floor_of(0.5)}, 1.0)).size(), 0u);
  // still slides
  EXPECT_EQ(changes_in(with_contact({sliding_block(0.5, 9.0), floor_of(0.5)}, 1.0)).size(), 1u);
  // without friction there are no modes
  EXPECT_EQ(changes_in(with_contact({sliding_block(0.0, 2.0), floor_of(0.5)}, 1.0)).size(), 0u);
}

// A table shaken at 1 Hz, at most 1.3 times as fast as friction can follow: twice a period the
// block slides and is caught up with.
TEST(ContactModes, SlidingAndStickingTakeTurns) {
  auto table = floor_of(0.5);
  table.motion = scene::PrescribedMotion{Vector3d::Zero(), {0.1615, 0, 0}, 2 * 3.14159265358979};
  const auto changes = changes_in(with_contact({sliding_block(0.5, 0.0), table}, 5.0));
  // told of every step there would be 300
  EXPECT_NEAR(static_cast<double>(changes.size()), 5 * 4, 2);
  for (std::size_t i = 1; i < changes.size(); ++i) {
    EXPECT_NE(changes[i].kind, changes[i - 1].kind) << i;
    EXPECT_GE(changes[i].time, changes[i - 1].time + 0.05) << i;
  }
}

// On a slope as steep as friction holds, to a billionth: the force lies on the cone, and nothing
// slips.
TEST(ContactModes, FrictionAtItsLimitIsNoSliding) {
  const double angle = 0.4;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  auto block = rough(box("block", {0.1, 0.1, 0.05}, 1.0, 0.05 * normal, Vector3d::Zero()),
                     std::tan(angle) * (1 + 1e-10)),
       ramp = rough(plane("ramp", Vector3d::Zero(), normal), 1.0);
  block.world_from_body = ramp.world_from_body =
      Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  EXPECT_EQ(changes_in(with_contact({block, ramp}, 1.0)).size(), 0u);
}

// Shaken at 30 Hz it sticks and slides sixty times a second.
TEST(ContactModes, ChatterIsReportedAtMostTwentyTimesASecond) {
  auto table = floor_of(0.5);
  const double w = 2 * 3.14159265358979 * 30;
  table.motion = scene::PrescribedMotion{Vector3d::Zero(), {1.3 * 0.5 * kG / (w * w), 0, 0}, w};
  scene::Scene scene = with_contact({sliding_block(0.5, 0.0), table}, 1.0);
  scene.step_s = 1.0 / 600;
  const auto changes = changes_in(scene);
  EXPECT_GE(changes.size(), 5u);
  EXPECT_LE(changes.size(), 20u);
}

}  // namespace
}  // namespace tumble::testing::contact_modes_test
