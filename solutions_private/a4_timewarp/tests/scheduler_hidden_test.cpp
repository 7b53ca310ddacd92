#include "framework/core/random.h"
#include "framework/effects/gravity/gravity.h"
#include "tests/a4_timewarp/scene_fixtures.h"

namespace tumble::a4_testing {
namespace {

TEST(Scheduler, KeepsOtherBoxesInOrder) {
  for (const std::uint64_t seed : {441, 442, 443})
    expect_the_references_trace(balls_in_a_box(4, seed, 2.5), 8,
                                "four balls in a box, seed " + std::to_string(seed));
}

TEST(Scheduler, KeepsBouncingBallsInOrder) {
  std::vector<scene::BodySpec> bodies{wall("floor", {0, 0, 0}, {0, 0, 1})};
  for (int i = 0; i < 4; ++i)
    bodies.push_back(ball("ball " + std::to_string(i + 1), {0.04 * i, 0.03 * i, 0.5 + 0.4 * i},
                          Vector3d::Zero()));
  scene::Scene scene = scene_of(bodies, 2.0, 0.1);
  effects::set_gravity(scene, Vector3d(0, 0, -9.81));
  expect_the_references_trace(scene, 12, "four balls above each other fall on a floor");
}

TEST(Scheduler, KeepsTiesInOrder) {
  // Two rows of three that touch, each hit at the same instant: effects of effects at one time, in
  // two places.
  std::vector<scene::BodySpec> bodies;
  for (int row = 0; row < 2; ++row) {
    for (int i = 0; i < 3; ++i)
      bodies.push_back(ball("ball " + std::to_string(row) + std::to_string(i),
                            {0.2 * i, 4.0 * row, 0}, Vector3d::Zero()));
    bodies.push_back(ball("cue " + std::to_string(row), {-1.25, 4.0 * row, 0}, {1, 0, 0}));
  }
  expect_the_references_trace(
      scene_of(bodies, 3.0, 0.25), 6,
      "two rows of three balls that touch are hit by two others at the same instant");
}

TEST(Scheduler, KeepsOtherHeapsInOrder) {
  expect_the_references_trace(
      heap_of_balls({-0.12, 0.01, 0.6}, 0.35), 6,
      "a heap of three balls slides apart, and another one falls on its side");
}

TEST(Scheduler, LooksAtBallsThatDriftSlowly) {
  std::vector<scene::BodySpec> bodies{
      wall("left", {-0.6, 0, 0}, {1, 0, 0}), ball("slow", {0.0, 0, 0}, {0.002, 0, 0}),
      ball("fast", {0.5, 0, 0}, {-2.5, 0, 0}), ball("third", {1.5, 0.05, 0}, {-0.7, 0, 0})};
  expect_the_references_trace(scene_of(bodies, 3.0, 0.2), 4,
                              "a slow ball between a wall and a fast one");
}

}  // namespace
}  // namespace tumble::a4_testing
