// Only the effects that a scene calls for are simulated: counters of every other effect stay at 0.
#include <map>

#include <gtest/gtest.h>

#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

// By effect: what it counts.
const std::map<std::string, std::vector<std::string>> kCountersOf = {
    {"gravity", {"gravity_calls"}},
    {"spring", {"spring_calls"}},
    {"rod", {"rod_calls"}},
    {"joint", {"joint_calls"}},
    {"drag", {"drag_calls"}},
    {"motor", {"motor_calls"}},
    {"contact", {"contact_solves", "contact_points", "contacts_begun"}},
    {"friction", {"friction_points"}},
    {"point force", {"point_force_calls"}},
    {"collision", {"impacts", "impulses"}},
};

using Adds = void (*)(scene::Scene&);

/// Two bodies that fly; each effect adds what calls for it.
scene::Scene bare() {
  auto a = ball("a", 0.1, 1.0, {0, 0, 1}, {0.1, 0, 0}), b = box("b", {0.1, 0.1, 0.1}, 1.0, {1, 0, 1}, Vector3d::Zero());
  scene::Scene scene = scene_of({a, b}, 0.5);
  scene.rest_speed_m_s = 1e-3;
  return scene;
}

const std::map<std::string, Adds> kEffects = {
    {"gravity", [](scene::Scene& s) { s.gravity_m_s2 = Vector3d(0, 0, -1); }},
    {"spring", [](scene::Scene& s) { s.springs.push_back({"s", {"", {0, 0, 2}}, {"a", Vector3d::Zero()}, 10.0, 0.1, 1.0}); }},
    {"rod",
     [](scene::Scene& s) {
       s.rods.push_back({"r", {"", {0, 0, 2}}, {"a", Vector3d::Zero()}, 1.0});
       s.stabilisation.emplace();
     }},
    {"joint",
     [](scene::Scene& s) {
       s.joints.push_back({"j", scene::JointKind::kHinge, "b", "", {1, 0, 2}, Vector3d::UnitY()});
       s.stabilisation.emplace();
     }},
    {"drag", [](scene::Scene& s) { s.drags.push_back({"a", 0.1, 0.1}); }},
    {"motor",
     [](scene::Scene& s) {
       kEffects.at("joint")(s);
       scene::MotorSpec motor;
       motor.joint = "j";
       motor.stiffness_n_m_rad = motor.offset_rad = 1.0;
       s.motors.push_back(motor);
     }},
    {"contact",
     [](scene::Scene& s) {
       kEffects.at("gravity")(s);
       s.bodies.push_back(plane("floor", {0, 0, 0.9}, Vector3d::UnitZ()));
       for (scene::BodySpec& body : s.bodies) body.restitution = 0.0;
       s.contact.emplace();
     }},
    {"friction",
     [](scene::Scene& s) {
       kEffects.at("contact")(s);
       for (scene::BodySpec& body : s.bodies) body.friction = 0.5;
     }},
    {"point force", [](scene::Scene& s) { s.point_forces.push_back({"a", {1, 0, 0}, {0, 0, 1}, 0.0, 0.1}); }},
    {"collision",
     [](scene::Scene& s) {
       s.bodies[0].velocity_m_s = {5, 0, 0};
     }},
};

TEST(Effects, OnlyWhatASceneAsksForRuns) {
  const Laws laws = reference_laws();
  // Effects that stand on others.
  const std::map<std::string, std::vector<std::string>> brings = {{"motor", {"joint"}}, {"contact", {"gravity"}}, {"friction", {"contact", "gravity"}}};
  for (const auto& [effect, add] : kEffects) {
    scene::Scene scene = bare();
    add(scene);
    const Trajectory result = run(scene, laws);
    EXPECT_EQ(result.stopped_by, "") << effect;
    std::vector<std::string> expected{effect};
    if (const auto more = brings.find(effect); more != brings.end()) expected.insert(expected.end(), more->second.begin(), more->second.end());
    for (const auto& [other, counters] : kCountersOf) {
      const bool asked = std::find(expected.begin(), expected.end(), other) != expected.end();
      for (const std::string& counter : counters) {
        const std::uint64_t count = result.counters.counts.at(counter);
        if (asked) EXPECT_GT(count, 0u) << counter << " in a scene with " << effect;
        else EXPECT_EQ(count, 0u) << counter << " in a scene with " << effect;
      }
    }
  }
}

// Bodies that may not meet are not looked at by collision finding.
TEST(Effects, BodiesThatDoNotCollideCostNoCollisionFinding) {
  scene::Scene scene = bare();
  scene.bodies[0].velocity_m_s = {5, 0, 0};
  for (scene::BodySpec& body : scene.bodies) body.collides = false;
  const Trajectory result = run(scene, reference_laws());
  for (const char* counter : {"candidate_pairs", "gap_evaluations", "root_findings", "impacts"}) EXPECT_EQ(result.counters.counts.at(counter), 0u) << counter;
}

}  // namespace
}  // namespace tumble::testing
