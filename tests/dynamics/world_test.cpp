// A world is what its scene asks for, and nothing else.
#include "framework/dynamics/world.h"
#include "framework/effects/build_world.h"
#include "framework/effects/drag/drag.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/invariants.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/dynamics/anchors.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
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
  EXPECT_TRUE(world.effects.of<effects::PointForce>().empty());
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
  EXPECT_NEAR(kinetic_energy(state, world.bodies[0].inertia), 0.5 * 2 * 10 + 0.5 * 0.2 * 25,
              20 * kEps * 12.5);
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
  pushed.effects.of<effects::PointForceSpec>() = {
      {.body = "b", .force_n = {1, 0, 0}, .point_m = {0, 0, 0}, .start_s = 0, .duration_s = 1}};
  EXPECT_THROW(build_world(pushed), UserError);
}

TEST(World, TurnsAngularVelocityIntoMomentumAndBack) {
  Random random(31);
  for (int i = 0; i < 100; ++i) {
    const Inertia inertia = finite_inertia(1.0, random_moments(random).asDiagonal());
    RigidBodyState state{Vector3d::Zero(), random_rotation(random), Vector3d::Zero(),
                         random_vector(random, 5)};
    const Vector3d omega_world = omega_of(state, inertia);
    const Vector3d back = angular_momentum_of(omega_world, state.world_from_body, inertia);
    // moments differ by up to 100 times
    EXPECT_LE((back - state.angular_momentum_world).norm(), 2000 * kEps * 5);
    EXPECT_NEAR(kinetic_energy(state, inertia), 0.5 * omega_world.dot(state.angular_momentum_world),
                20 * kEps * kinetic_energy(state, inertia));
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
    const Vector3d rate =
        (prescribed_position(wall, t + h) - prescribed_position(wall, t - h)) / (2 * h);
    EXPECT_LE((prescribed_velocity(wall, t) - rate).norm(), 2e-9) << t;
  }
}

TEST(World, SumsInvariantsOverMovableBodiesAboutTheOrigin) {
  scene::Scene scene = scene_of({ball("a", 2.0), ball("b", 3.0)});
  effects::set_gravity(scene, Vector3d(0, 0, -10));
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

TEST(World, HasNoLinksThatTheSceneDoesNotAskFor) {
  const World world = build_world(scene_of({ball("a", 2.0), ball("b", 2.0)}));
  EXPECT_TRUE(world.effects.of<effects::SpringLink>().empty() &&
              world.effects.of<effects::RodLink>().empty() &&
              world.effects.of<effects::JointLink>().empty() &&
              world.effects.of<effects::Drag>().empty() &&
              world.effects.of<effects::Motor>().empty() && world.apart.empty());
  EXPECT_FALSE(world.contact.has_value());
  EXPECT_FALSE(world.stabilisation.has_value());
}

/// Two balls, the second turned by 90 degrees about z.
scene::Scene two_balls() {
  scene::Scene scene = scene_of({ball("a", 2.0), ball("b", 3.0)});
  scene.bodies[1].position_m = {4, 0, 0};
  scene.bodies[1].world_from_body =
      Quaterniond(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ()));
  return scene;
}

TEST(World, AnchorsMoveWithTheirBodies) {
  scene::Scene scene = two_balls();
  scene.effects.of<effects::SpringSpec>().push_back(
      {"coil", {"b", {1, 0, 0}}, {"", {4, 7, 0}}, 10.0, 1.0, 2.0, ""});
  World world = build_world(scene);
  const effects::SpringLink& link = world.effects.of<effects::SpringLink>()[0];
  EXPECT_EQ(link.a.body, 1);
  EXPECT_EQ(link.b.body, -1);
  std::vector<RigidBodyState> states = {world.bodies[0].state, world.bodies[1].state};
  EXPECT_LE((anchor_point(link.a, states) - Vector3d(4, 1, 0)).norm(), 10 * kEps * 4);
  states[1].momentum_world = 3.0 * Vector3d(0, 0, 5);
  states[1].angular_momentum_world =
      angular_momentum_of({0, 0, 2}, states[1].world_from_body, world.bodies[1].inertia);
  const AnchorState moving = anchor_state(link.a, world, states, 0.0);
  // v + w x (0, 1, 0)
  EXPECT_LE((moving.velocity_world - Vector3d(-2, 0, 5)).norm(), 50 * kEps * 5);
  EXPECT_EQ(anchor_state(link.b, world, states, 0.0).velocity_world, Vector3d::Zero());
  // E = 10 N/m / 2 (6 m - 2 m)^2
  EXPECT_NEAR(invariants_of(world, states).potential_energy, 80.0, 50 * kEps * 80);
}

TEST(World, AnchorOfAMovingWallFollowsIt) {
  scene::Scene scene = two_balls();
  scene.bodies[0].immovable = true;
  scene.bodies[0].mass_kg.reset();
  scene.bodies[0].motion = scene::PrescribedMotion{{0, 0, 2}, {0, 0, 0}, 0.0};
  scene.effects.of<effects::RodSpec>().push_back(
      {"stick", {"a", {0, 1, 0}}, {"b", {0, 0, 0}}, std::sqrt(17.0), ""});
  const World world = build_world(scene);
  const AnchorState moved = anchor_state(world.effects.of<effects::RodLink>()[0].a, world,
                                         {world.bodies[0].state, world.bodies[1].state}, 3.0);
  EXPECT_EQ(moved.point_world, Vector3d(0, 1, 6));
  EXPECT_EQ(moved.velocity_world, Vector3d(0, 0, 2));
  EXPECT_TRUE(world.stabilisation.has_value());
}

TEST(World, BothBodiesOfAJointSeeItsPointAndAxisInTheSamePlace) {
  scene::Scene scene = two_balls();
  effects::JointSpec hinge;
  hinge.name = "elbow";
  hinge.kind = effects::JointKind::kHinge;
  hinge.body_a = "b";
  hinge.body_b = "a";
  hinge.point_m = {2, 0.5, -1};
  hinge.axis = Vector3d(0.6, 0, -0.8);
  scene.effects.of<effects::JointSpec>().push_back(hinge);
  effects::MotorSpec motor;
  motor.joint = "elbow";
  scene.effects.of<effects::MotorSpec>().push_back(motor);
  const World world = build_world(scene);
  const effects::JointLink& link = world.effects.of<effects::JointLink>()[0];
  const std::vector<RigidBodyState> states = {world.bodies[0].state, world.bodies[1].state};
  EXPECT_LE((anchor_point(link.a, states) - hinge.point_m).norm(), 10 * kEps * 4);
  EXPECT_LE((anchor_point(link.b, states) - hinge.point_m).norm(), 10 * kEps * 4);
  EXPECT_LE((states[1].world_from_body * link.a_from_joint * Vector3d::UnitZ() - hinge.axis).norm(),
            20 * kEps);
  EXPECT_LE((states[0].world_from_body * link.b_from_joint * Vector3d::UnitZ() - hinge.axis).norm(),
            20 * kEps);
  EXPECT_EQ(world.effects.of<effects::Motor>()[0].hinge.name, link.name);
  EXPECT_EQ(world.apart, (std::vector<std::pair<int, int>>{{0, 1}}))
      << "joined bodies never collide";
}

TEST(World, RodsDoNotKeepFromCollidingAndPairsApartAreSortedOnce) {
  scene::Scene scene = two_balls();
  scene.effects.of<effects::RodSpec>().push_back(
      {"stick", {"a", {0, 0, 0}}, {"b", {0, 0, 0}}, 4.0, ""});
  EXPECT_TRUE(build_world(scene).apart.empty());
  scene.apart = {{"b", "a"}, {"a", "b"}};
  EXPECT_EQ(build_world(scene).apart, (std::vector<std::pair<int, int>>{{0, 1}}));
}

TEST(World, RefusesLinksThatCannotBe) {
  scene::Scene scene = two_balls();
  scene.effects.of<effects::SpringSpec>().push_back(
      {"coil", {"c", {0, 0, 0}}, {"", {0, 0, 0}}, 1, 0, 1, ""});
  EXPECT_THROW(build_world(scene), UserError);
  scene.effects.of<effects::SpringSpec>().clear();
  scene.effects.of<effects::RodSpec>().push_back(
      {"stick", {"", {0, 0, 0}}, {"", {1, 0, 0}}, 1, ""});
  EXPECT_THROW(build_world(scene), UserError);
  scene.effects.of<effects::RodSpec>().clear();
  scene.effects.of<effects::MotorSpec>().emplace_back();
  EXPECT_THROW(build_world(scene), UserError);
}

}  // namespace
}  // namespace tumble::testing
