/// Small scenes for tests of the engines, built without files.
#pragma once

#include <string>
#include <vector>

#include "framework/core/shortest_turn.h"
#include "framework/effects/gravity/gravity.h"
#include "framework/engines/run.h"
#include "tests/support/test_laws.h"

namespace tumble::testing {

inline const std::vector<std::string> kEngines{"rd", "ca", "ordered", "tw"};

inline scene::BodySpec ball(const std::string& name, double radius, double mass,
                            const Vector3d& position, const Vector3d& velocity) {
  scene::BodySpec body;
  body.name = name;
  body.shape = scene::SphereSpec{radius};
  body.mass_kg = mass;
  body.position_m = position;
  body.velocity_m_s = velocity;
  return body;
}

inline scene::BodySpec box(const std::string& name, const Vector3d& half_extents, double mass,
                           const Vector3d& position, const Vector3d& velocity) {
  scene::BodySpec body = ball(name, 1.0, mass, position, velocity);
  body.shape = scene::BoxSpec{half_extents};
  return body;
}

/// An immovable half-space through `point`, solid on the side away from `normal`.
inline scene::BodySpec plane(const std::string& name, const Vector3d& point,
                             const Vector3d& normal) {
  scene::BodySpec body;
  body.name = name;
  body.shape = scene::PlaneSpec{};
  body.immovable = true;
  body.position_m = point;
  body.world_from_body = shortest_turn(Vector3d::UnitZ(), normal);
  return body;
}

inline scene::Scene scene_of(std::vector<scene::BodySpec> bodies, double duration,
                             std::optional<Vector3d> gravity = std::nullopt) {
  scene::Scene scene;
  scene.name = "test";
  scene.duration_s = duration;
  if (gravity) effects::set_gravity(scene, *gravity);
  scene.bodies = std::move(bodies);
  return scene;
}

inline Trajectory run(const scene::Scene& scene, const Laws& laws = test_laws(),
                      double frame_rate_hz = 60.0) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.frame_rate_hz = frame_rate_hz;
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

inline std::vector<double> collision_times(const Trajectory& run) {
  std::vector<double> times;
  for (const Event& event : run.events)
    if (event.kind == EventKind::kCollision) times.push_back(event.time);
  return times;
}

}  // namespace tumble::testing
