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
    {"sleep", {"bodies_put_to_sleep", "body_steps_asleep"}},
};

/// By effect: the events that tell of it.
const std::map<std::string, std::vector<EventKind>> kEventsOf = {
    {"friction", {EventKind::kSlide}},
    {"contact", {EventKind::kContact}},
    {"point force", {EventKind::kForceOn, EventKind::kForceOff}},
    {"collision", {EventKind::kCollision}},
    {"sleep", {EventKind::kSleep}},
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
    {"sleep",
     [](scene::Scene& s) {
       kEffects.at("contact")(s);
       s.contact->sleep = true;
       s.duration_s = 0.7;
     }},
};

TEST(Effects, OnlyWhatASceneAsksForRuns) {
  const Laws laws = reference_laws();
  // Effects that stand on others.
  const std::map<std::string, std::vector<std::string>> brings = {{"motor", {"joint"}}, {"contact", {"gravity"}}, {"friction", {"contact", "gravity"}}, {"sleep", {"contact", "gravity"}}};
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
      if (!kEventsOf.contains(other)) continue;
      for (const EventKind kind : kEventsOf.at(other)) {
        const bool told = std::any_of(result.events.begin(), result.events.end(), [&](const Event& event) { return event.kind == kind; });
        EXPECT_EQ(told, asked) << "events of " << other << " in a scene with " << effect;
      }
    }
  }
}

/// A stack of five at rest, 20 balls that fall a kilometre above it, or both.
scene::Scene stack_and_balls(bool stack, bool balls) {
  std::vector<scene::BodySpec> bodies{plane("floor", Vector3d::Zero(), Vector3d::UnitZ())};
  for (int i = 0; i < 5 && stack; ++i) bodies.push_back(box("box " + std::to_string(i), {0.5, 0.5, 0.5}, 1.0, {0, 0, 0.5 + i}, Vector3d::Zero()));
  for (int i = 0; i < 20 && balls; ++i) bodies.push_back(ball("ball " + std::to_string(i), 0.1, 1.0, {3.0 * i, 0, 1000}, {0, 1, 0}));
  for (scene::BodySpec& body : bodies) {
    body.restitution = 0.0;
    body.friction = 0.5;
  }
  scene::Scene scene = scene_of(bodies, 1.0, Vector3d(0, 0, -9.81));
  scene.contact.emplace();
  return scene;
}

TEST(Effects, BodiesInFlightPayNothingForAStackAndItNothingForThem) {
  const Laws laws = reference_laws();
  const auto counts = [&](bool stack, bool balls) { return run(stack_and_balls(stack, balls), laws).counters.counts; };
  const auto alone = counts(true, false), flying = counts(false, true), both = counts(true, true);
  for (const char* counter : {"candidate_pairs", "gap_evaluations", "root_findings", "contact_solves", "contact_points", "friction_points", "contact_sweeps", "contact_factorisations", "nudges"}) {
    EXPECT_EQ(flying.at(counter), 0u) << counter;
    EXPECT_EQ(both.at(counter), alone.at(counter)) << counter;
  }
  for (const char* counter : {"integrations", "undone_integrations", "derivative_evaluations", "gravity_calls"}) EXPECT_EQ(both.at(counter), alone.at(counter) + flying.at(counter)) << counter;
  EXPECT_GT(alone.at("contact_solves"), 0u);
  EXPECT_EQ(both.at("steps"), alone.at("steps"));
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
