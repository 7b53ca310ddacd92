/// A ball at rest on a floor, and what is driven into it: walls, lids, plates from below. Scenes
/// without persistent contacts.
#pragma once

#include "tests/engines/scenes.h"

namespace tumble::testing {

inline scene::BodySpec driven(scene::BodySpec body, const Vector3d& velocity,
                              const Vector3d& amplitude = Vector3d::Zero(),
                              double frequency = 0.0) {
  body.immovable = true;
  body.mass_kg.reset();
  body.motion = scene::PrescribedMotion{velocity, amplitude, frequency};
  return body;
}

/// A wall whose face is at x at time 0, on the side of larger x.
inline scene::BodySpec wall_with_face_at(double x) {
  return box("wall", {0.05, 0.5, 0.5}, 1.0, {x - 0.05, 0, 0.51}, Vector3d::Zero());
}

/// The ball, of radius 0.1 m about (0, 0, 0.1 m + height), is body 1. It does not bounce on the
/// floor, and with restitution 1/2 off what is driven.
inline scene::Scene ball_and_driven(const scene::BodySpec& what, double height, double duration) {
  scene::BodySpec floor = plane("floor", Vector3d::Zero(), Vector3d::UnitZ()),
                  ball_at_rest = ball("ball", 0.1, 1.0, {0, 0, 0.1 + height}, Vector3d::Zero()),
                  other = what;
  floor.restitution = 0.0;
  ball_at_rest.restitution = 0.5;
  other.restitution = 1.0;
  scene::Scene scene = scene_of({floor, ball_at_rest, other}, duration, Vector3d(0, 0, -9.81));
  scene.step_s = 1.0 / 240;
  return scene;
}

}  // namespace tumble::testing
