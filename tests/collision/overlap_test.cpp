// The test oracle for overlaps (tests/support/overlap.h), against the same computation with 33
// digits.
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "tests/collision/exhaustive.h"
#include "tests/collision/hulls.h"
#include "tests/support/overlap.h"

namespace tumble::testing {
namespace {

constexpr double kEpsilon = 2.220446049250313e-16;

WorldBody solid(const Shape& shape) {
  WorldBody body;
  body.shape = shape;
  body.inertia = finite_inertia(1.0, Matrix3d::Identity());
  return body;
}

BodyPose placed_at(const Vector3d& place, const Quaterniond& turn) {
  return {place, turn, Vector3d::Zero(), Vector3d::Zero()};
}

Quaterniond some_turn(Random& random) {
  const double a = random.between(-1, 1), b = random.between(-1, 1), c = random.between(-1, 1),
               d = random.between(-1, 1);
  return Quaterniond(a, b, c, d).normalized();
}

TEST(DeepestOverlap, OfTwoRocksEqualsTheExhaustiveMethod) {
  // Dot products of lengths below 2 m, some twenty roundings: 40 eps. A missing axis changes some
  // depth by more than 1e-3 m.
  Random random(5);
  int overlapping = 0;
  for (int k = 0; k < 60; ++k) {
    World world;
    world.bodies = {solid(random_hull(12, static_cast<unsigned>(k))),
                    solid(random_hull(10, static_cast<unsigned>(1000 + k)))};
    const Vector3d apart = random.between(0.3, 1.0) * (some_turn(random) * Vector3d::UnitX());
    const std::vector<BodyPose> poses{placed_at(Vector3d::Zero(), some_turn(random)),
                                      placed_at(apart, some_turn(random))};
    std::vector<PlacedSurface> surfaces;
    for (int i = 0; i < 2; ++i)
      surfaces.push_back(placed_exactly(std::get<MeshSolid>(world.bodies[i].shape).mesh_body,
                                        {poses[i].com_world, poses[i].world_from_body},
                                        Vector3d::Zero()));
    const double exact =
        std::max(0.0, -static_cast<double>(exact_separation(surfaces[0], surfaces[1])));
    overlapping += exact > 0 ? 1 : 0;
    EXPECT_NEAR(deepest_overlap(world, poses), exact, 40 * kEpsilon) << "pair " << k;
  }
  EXPECT_GT(overlapping, 20);
  EXPECT_LT(overlapping, 60);
}

TEST(DeepestOverlap, OfBallsAndFloorsEqualsTheClosedForm) {
  World world;
  world.bodies = {solid(Sphere{0.5}), solid(Sphere{0.25}), solid(Box{Vector3d(0.5, 0.5, 0.5)}),
                  solid(HalfSpace{})};
  world.bodies[3].inertia = infinite_inertia();
  world.bodies[3].state.com_world = Vector3d(0, 0, -10);
  world.bodies[3].state.world_from_body = Quaterniond::Identity();
  std::vector<BodyPose> poses{placed_at(Vector3d(0, 0, 0), Quaterniond::Identity()),
                              placed_at(Vector3d(0.7, 0, 0), Quaterniond::Identity()),
                              placed_at(Vector3d(20, 0, 0), Quaterniond::Identity()),
                              placed_at(Vector3d(0, 0, -10), Quaterniond::Identity())};
  EXPECT_NEAR(deepest_overlap(world, poses), 0.05, 4 * kEpsilon);  // 0.5 + 0.25 - 0.7
  // the box penetrates the floor by 0.1 m
  poses[2].com_world.z() = -9.6;
  EXPECT_NEAR(deepest_overlap(world, poses), 0.1, 40 * kEpsilon);  // eps times heights of 10 m
  poses[1].com_world.x() = 0.75;
  poses[2].com_world.z() = 0.0;
  EXPECT_EQ(deepest_overlap(world, poses), 0.0);
}

}  // namespace
}  // namespace tumble::testing
