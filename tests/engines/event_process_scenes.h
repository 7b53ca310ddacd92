/// Scenes of linked bodies and bodies in persistent contact, among others in free flight.
#pragma once

#include "framework/effects/drag/drag.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/effects/point_force/point_force.h"
#include "framework/effects/rod/rod.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/event_scenes.h"

namespace tumble::testing {

inline const Vector3d kEarth(0, 0, -9.81);

/// Bobs on rods from the ceiling, each a process, and balls in free flight among them; bob 0 is
/// slowed by drag, a force acts on ball 0.
inline scene::Scene pendula_and_balls(int pendula, double duration) {
  std::vector<scene::BodySpec> bodies;
  scene::Scene scene;
  for (int i = 0; i < pendula; ++i) {
    const std::string bob = "bob" + std::to_string(i);
    bodies.push_back(ball(bob, 0.1, 1.0, {0.45 * i, 0, 0}, {0.8 - 0.2 * i, 0, 0}));
    scene.effects.of<effects::RodSpec>().push_back(
        {"rod" + std::to_string(i), {"", {0.45 * i, 0, 1}}, {bob, Vector3d::Zero()}, 1.0});
    bodies.push_back(ball("ball" + std::to_string(i), 0.08, 0.5,
                          {0.45 * i + 0.05, 0.35, 0.02 * i + 0.3}, {0.0, -1.0, 0.6}));
  }
  bodies.push_back(plane("wall", {0, -0.8, 0}, {0, 1, 0}));
  bodies.push_back(plane("floor", {0, 0, -0.4}, {0, 0, 1}));
  bodies.push_back(plane("back", {0, 0.9, 0}, {0, -1, 0}));
  scene.name = "pendula";
  scene.bodies = std::move(bodies);
  scene.duration_s = duration;
  effects::set_gravity(scene, kEarth);
  scene.stabilisation = scene::StabilisationSpec{};
  scene.effects.of<effects::DragSpec>().push_back({"bob0", 0.2, 0.0});
  scene.effects.of<effects::PointForceSpec>().push_back(
      {"ball0", {0.5, 0, 1.0}, {0.05, 0.35, 0.38}, 0.1, 0.3});
  return scene;
}

/// A tower of three boxes and a ball shot at it; restitution 0 within the tower.
inline scene::Scene tower_and_projectile(double shot_m_s) {
  std::vector<scene::BodySpec> bodies{plane("floor", {0, 0, 0}, {0, 0, 1})};
  for (int i = 0; i < 3; ++i)
    bodies.push_back(box("block" + std::to_string(i), {0.1, 0.1, 0.1}, 1.0,
                         {0, 0, 0.1 + 0.23 * i + 0.02}, Vector3d::Zero()));
  bodies.push_back(ball("shot", 0.05, 0.4, {-2, 0, 0.33}, {shot_m_s, 0, 0.9}));
  for (scene::BodySpec& body : bodies) {
    body.restitution = 0.0;
    body.friction = 0.4;
  }
  scene::Scene scene = scene_of(bodies, 0.9, kEarth);
  scene.contact = scene::ContactSpec{};
  return scene;
}

}  // namespace tumble::testing
