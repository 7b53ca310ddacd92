// A world is what its scene asks for, and nothing else.
#include "framework/dynamics/world.h"

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "tests/dynamics/tops.h"

namespace tumble::testing {
namespace {

scene::BodySpec ball(const std::string& name, double mass) {
  scene::BodySpec body;
  body.name = name;
  body.shape = scene::SphereSpec{0.5};
  body.mass_kg = mass;
  return body;
}

scene::Scene scene_of(std::vector<scene::BodySpec> bodies) {
  scene::Scene scene;
  scene.name = "test";
  scene.duration_s = 1.0;
  scene.bodies = std::move(bodies);
  return scene;
}

TEST(World, HasNoEffectThatTheSceneDoesNotAskFor) {
  const World world = build_world(scene_of({ball("a", 2.0)}));
  EXPECT_FALSE(world.gravity_world.has_value());
  EXPECT_TRUE(world.point_forces.empty());
}

TEST(World, StartsWithTheMomentaOfTheVelocitiesGiven) {
  scene::BodySpec a = ball("a", 2.0);
  a.velocity_m_s = {3, 0, -1};
  a.omega_world_rad_s = {0, 5, 0};
  const World world = build_world(scene_of({a}));
  const RigidBodyState& state = world.bodies[0].state;
  EXPECT_LE((state.momentum_world - Vector3d(6, 0, -2)).norm(), 4 * kEps);
  // 2/5 m r^2 = 0.2 kg m^2
  EXPECT_LE((state.angular_momentum_world - Vector3d(0, 1, 0)).norm(), 4 * kEps);
  EXPECT_LE((omega_of(state, world.bodies[0].inertia) - Vector3d(0, 5, 0)).norm(), 20 * kEps);
  EXPECT_NEAR(kinetic_energy(state, world.bodies[0].inertia), 0.5 * 2 * 10 + 0.5 * 0.2 * 25, 20 * kEps * 12.5);
}

TEST(World, RefusesWhatCannotBe) {
  scene::BodySpec turning_wall = ball("wall", 1.0);
  turning_wall.mass_kg.reset();
  turning_wall.immovable = true;
  turning_wall.omega_world_rad_s = {0, 0, 1};
  EXPECT_THROW(build_world(scene_of({turning_wall})), UserError);
  scene::BodySpec plane = ball("plane", 1.0);
  plane.shape = scene::PlaneSpec{};
  plane.inertia_body_kg_m2 = Matrix3d::Identity();
  EXPECT_THROW(build_world(scene_of({plane})), UserError);
  scene::Scene pushed = scene_of({ball("a", 1.0)});
  pushed.point_forces = {{.body = "b", .force_n = {1, 0, 0}, .point_m = {0, 0, 0}, .start_s = 0, .duration_s = 1}};
  EXPECT_THROW(build_world(pushed), UserError);
}

TEST(World, TurnsAngularVelocityIntoMomentumAndBack) {
  Random random(31);
  for (int i = 0; i < 100; ++i) {
    const Inertia inertia = finite_inertia(1.0, random_moments(random).asDiagonal());
    RigidBodyState state{Vector3d::Zero(), random_rotation(random), Vector3d::Zero(), random_vector(random, 5)};
    const Vector3d omega_world = omega_of(state, inertia);
    const Vector3d back = angular_momentum_of(omega_world, state.world_from_body, inertia);
    EXPECT_LE((back - state.angular_momentum_world).norm(), 2000 * kEps * 5);  // moments differ by up to 100 times
    EXPECT_NEAR(kinetic_energy(state, inertia), 0.5 * omega_world.dot(state.angular_momentum_world), 20 * kEps * kinetic_energy(state, inertia));
  }
}

TEST(World, MovesAWallAsPrescribedWithTheRateOfItsPosition) {
  WorldBody wall;
  wall.inertia = infinite_inertia();
  wall.com_at_0_world = {0, 0, 1};
  wall.motion.velocity_m_s = {0, 0, 0.5};
  wall.motion.amplitude_m = {0, 0, 0.05};
  wall.motion.angular_frequency_rad_s = 10.0;
  EXPECT_EQ(prescribed_position(wall, 0.0), Vector3d(0, 0, 1));
  EXPECT_EQ(prescribed_velocity(wall, 0.0), Vector3d(0, 0, 1));
  for (const double t : {0.1, 0.7, 3.0}) {
    // Central difference of h = 1e-5 s: A w^3 h^2 / 6 = 1e-9 of truncation, 2e-11 of rounding.
    const double h = 1e-5;
    const Vector3d rate = (prescribed_position(wall, t + h) - prescribed_position(wall, t - h)) / (2 * h);
    EXPECT_LE((prescribed_velocity(wall, t) - rate).norm(), 2e-9) << t;
  }
}

TEST(World, SumsInvariantsOverMovableBodiesAboutTheOrigin) {
  scene::Scene scene = scene_of({ball("a", 2.0), ball("b", 3.0)});
  scene.gravity_m_s2 = Vector3d(0, 0, -10);
  scene.bodies[0].position_m = {1, 0, 4};
  scene.bodies[0].velocity_m_s = {0, 1, 0};
  scene.bodies[1].immovable = true;
  scene.bodies[1].mass_kg.reset();
  scene.bodies[1].position_m = {5, 5, 5};
  const World world = build_world(scene);
  const Invariants sums = invariants_of(world, {world.bodies[0].state, world.bodies[1].state});
  EXPECT_NEAR(sums.kinetic_energy, 1.0, 4 * kEps);
  EXPECT_NEAR(sums.potential_energy, 80.0, 4 * kEps * 80);
  EXPECT_EQ(sums.momentum_world, Vector3d(0, 2, 0));
  EXPECT_EQ(sums.angular_momentum_world, Vector3d(-8, 0, 2));
}

}  // namespace
}  // namespace tumble::testing
