/// A scene for each effect that asks for it and for nothing else, and the counters that tell of it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/effects/drag/drag.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/joint/joint.h"
#include "framework/effects/motor/motor.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/effects/spring/spring.h"
#include "framework/effects/water/water.h"
#include "tests/engines/scenes.h"

namespace tumble::testing {

/// By effect: what it counts.
inline const std::map<std::string, std::vector<std::string>> kCountersOf = {
    {"gravity", {"gravity_calls"}},
    {"spring", {"spring_calls"}},
    {"rod", {"rod_calls"}},
    {"joint", {"joint_calls"}},
    {"drag", {"drag_calls"}},
    {"motor", {"motor_calls"}},
    {"water", {"water_calls"}},
    {"contact", {"contact_solves", "contact_points", "contacts_begun"}},
    {"friction", {"friction_points"}},
    {"point force", {"point_force_calls"}},
    {"collision", {"impacts", "impulses"}},
    {"callback", {"callback_calls"}},
    {"sleep", {"bodies_put_to_sleep", "body_steps_asleep"}},
};

inline Trajectory run_with(const scene::Scene& scene, const Laws& laws,
                           const engines::RunOptions& options) {
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

using AddsEffect = void (*)(scene::Scene&);

/// Two bodies that fly; each effect adds what calls for it.
inline scene::Scene bare() {
  auto a = ball("a", 0.1, 1.0, {0, 0, 1}, {0.1, 0, 0}),
       b = box("b", {0.1, 0.1, 0.1}, 1.0, {1, 0, 1}, Vector3d::Zero());
  scene::Scene scene = scene_of({a, b}, 0.5);
  scene.rest_speed_m_s = 1e-3;
  return scene;
}

inline const std::map<std::string, AddsEffect> kEffects = {
    {"gravity", [](scene::Scene& s) { effects::set_gravity(s, Vector3d(0, 0, -1)); }},
    {"spring",
     [](scene::Scene& s) {
       s.effects.of<effects::SpringSpec>().push_back(
           {"s", {"", {0, 0, 2}}, {"a", Vector3d::Zero()}, 10.0, 0.1, 1.0});
     }},
    {"rod",
     [](scene::Scene& s) {
       s.effects.of<effects::RodSpec>().push_back(
           {"r", {"", {0, 0, 2}}, {"a", Vector3d::Zero()}, 1.0});
       s.stabilisation.emplace();
     }},
    {"joint",
     [](scene::Scene& s) {
       s.effects.of<effects::JointSpec>().push_back(
           {"j", effects::JointKind::kHinge, "b", "", {1, 0, 2}, Vector3d::UnitY()});
       s.stabilisation.emplace();
     }},
    {"drag",
     [](scene::Scene& s) {
       s.effects.of<effects::DragSpec>().push_back({"a", 0.1, 0.1});
     }},
    {"motor",
     [](scene::Scene& s) {
       kEffects.at("joint")(s);
       effects::MotorSpec motor;
       motor.joint = "j";
       motor.stiffness_n_m_rad = motor.offset_rad = 1.0;
       s.effects.of<effects::MotorSpec>().push_back(motor);
     }},
    {"water",
     [](scene::Scene& s) {
       kEffects.at("gravity")(s);
       s.effects.of<effects::WaterSpec>().emplace_back().surface_m.z() = 1.0;
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
    {"point force",
     [](scene::Scene& s) {
       s.effects.of<effects::PointForceSpec>().push_back({"a", {1, 0, 0}, {0, 0, 1}, 0.0, 0.1});
     }},
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

}  // namespace tumble::testing
