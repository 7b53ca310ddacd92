// What lies on a body weighs on its links; and by what its contacts were solved.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "framework/effects/build_world.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/rod/rod.h"
#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"
#include "tests/engines/watched_runs.h"

namespace tumble::testing {
namespace {

// ---- What lies on a body weighs on its links ---------------------------------------------------

scene::BodySpec slab(const std::string& name, const Vector3d& half, double mass, const Vector3d& at,
                     double friction = 0.0) {
  scene::BodySpec body = box(name, half, mass, at, Vector3d::Zero());
  body.restitution = 0.0;
  body.friction = friction;
  return body;
}

scene::Scene at_rest(std::vector<scene::BodySpec> bodies) {
  scene::Scene scene = scene_of(std::move(bodies), 0.3, kEarthGravity);
  scene.contact.emplace();
  scene.stabilisation.emplace();
  scene.step_s = 0.005;
  return scene;
}

/// Of one newton: contacts at rest are solved to the last digits, and bodies settle over shells of
/// 1e-10 m.
constexpr double kForce = 1e-5;

TEST(LinkForces, ARodHoldsWhatLiesOnItsBlock) {
  scene::Scene scene = at_rest({slab("block", {0.3, 0.3, 0.05}, 4.0, {0, 0, 1}),
                                slab("box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 1.15}),
                                slab("second", {0.05, 0.05, 0.05}, 2.0, {0, 0, 1.30})});
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", Vector3d(0, 0, 2)}, {"block", Vector3d(0, 0, 0.05)}, 0.95});
  for (const std::string& engine : kEngines)
    EXPECT_NEAR(run_by(engine, scene).frames.back().rod_tensions.at(0), 7.0 * 9.81, kForce)
        << engine;
  scene.bodies.pop_back();
  for (const std::string& engine : kEngines)
    EXPECT_NEAR(run_by(engine, scene).frames.back().rod_tensions.at(0), 5.0 * 9.81, kForce)
        << engine;
}

TEST(LinkForces, AWeldHoldsABoxThatStandsOnASlope) {
  const double angle = 20 * std::numbers::pi / 180;
  const Vector3d normal(std::sin(angle), 0, std::cos(angle));
  scene::Scene scene = at_rest({slab("shelf", {0.4, 0.4, 0.05}, 3.0, Vector3d::Zero(), 0.8),
                                slab("box", {0.1, 0.1, 0.1}, 1.5, 0.15 * normal, 0.8)});
  for (scene::BodySpec& body : scene.bodies)
    body.world_from_body = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  scene.effects.of<effects::JointSpec>().push_back(
      {"weld", effects::JointKind::kWeld, "shelf", "", Vector3d::Zero(), Vector3d::UnitZ()});
  // Friction and the normal force add up to the box's weight.
  for (const std::string& engine : kEngines)
    EXPECT_NEAR(run_by(engine, scene).frames.back().joint_forces.at(0), 4.5 * 9.81, kForce)
        << engine;
}

// Moments about the hinge: the rod at the far end holds half of the beam and its share of the box.
TEST(LinkForces, AHingeAndARodShareABoxByItsLever) {
  const double half = 0.5, lever = 0.8;
  scene::Scene scene = at_rest({slab("beam", {half, 0.1, 0.02}, 2.0, {half, 0, 0}),
                                slab("box", {0.05, 0.05, 0.05}, 1.0, {lever, 0, 0.07})});
  scene.effects.of<effects::JointSpec>().push_back(
      {"hinge", effects::JointKind::kHinge, "beam", "", Vector3d::Zero(), Vector3d::UnitY()});
  scene.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", Vector3d(2 * half, 0, 1)}, {"beam", Vector3d(half, 0, 0)}, 1.0});
  for (const std::string& engine : kEngines) {
    const Frame frame = run_by(engine, scene).frames.back();
    const double rod = 9.81 * (2.0 * half + 1.0 * lever) / (2 * half);
    EXPECT_NEAR(frame.rod_tensions.at(0), rod, kForce) << engine;
    EXPECT_NEAR(frame.joint_forces.at(0), 3.0 * 9.81 - rod, kForce) << engine;
  }
}

// ---- By what a contact was solved --------------------------------------------------------------

scene::Scene box_on_a_floor(double friction) {
  scene::BodySpec floor = plane("floor", Vector3d::Zero(), Vector3d::UnitZ());
  floor.friction = friction;
  return at_rest({floor, slab("box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 0.1}, friction)});
}

// Neither what rubs nor what a rod holds is a matter of contact_forces. The rod lies level, so that
// the floor bears the box.
TEST(ContactPoints, SayWhetherContactForcesFoundThem) {
  scene::Scene on_a_rod = box_on_a_floor(0.0);
  on_a_rod.effects.of<effects::RodSpec>().push_back(
      {"rod", {"", Vector3d(1, 0, 0.1)}, {"box", Vector3d::Zero()}, 1.0});
  for (const auto& [scene, expected] :
       {std::pair{box_on_a_floor(0.0), true}, {box_on_a_floor(0.5), false}, {on_a_rod, false}})
    for (const std::string& engine : kEngines) {
      const Trajectory run = run_by(engine, scene);
      ASSERT_FALSE(run.frames.back().contacts.empty()) << engine << said(run);
      for (const ContactPoint& contact : run.frames.back().contacts)
        EXPECT_EQ(contact.by_contact_forces, expected) << engine;
    }
}

// What is said of a box whose energy has run away, with one contact that pushes it.
std::string said_of_runaway(bool by_contact_forces, const Laws& laws) {
  const World world = build_world(box_on_a_floor(0.0));
  const std::vector<RigidBodyState> states{world.bodies[0].state, world.bodies[1].state};
  const std::vector<ContactPoint> contacts{
      {1, 0, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d(0, 0, 9.81), by_contact_forces}};
  const engines::LinkForces links(world);
  return engines::runaway_message(0.1, world, {1, 100.0, 1.0, 0.0}, {states, links, contacts},
                                  laws);
}

TEST(Runaway, NamesContactForcesOnlyWhereTheyWereAsked) {
  Laws laws = reference_laws();
  laws.constraint_source = "a3 student";
  const std::string theirs = said_of_runaway(true, laws), ours = said_of_runaway(false, laws);
  EXPECT_NE(theirs.find("'floor' (contact_forces of a3 student)"), std::string::npos) << theirs;
  EXPECT_NE(ours.find("'floor' (impulses of the framework)"), std::string::npos) << ours;
  EXPECT_EQ(ours.find("a3 student"), std::string::npos) << ours;
}

}  // namespace
}  // namespace tumble::testing
