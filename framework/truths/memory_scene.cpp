#include "framework/truths/memory_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "framework/core/shortest_turn.h"
#include "framework/scene/write_entries.h"

namespace tumble::truths {

scene::Scene empty_scene(const std::string& name, double duration, double restitution_threshold) {
  scene::Scene scene;
  scene.name = name;
  scene.duration_s = duration;
  scene.rest_speed_m_s = restitution_threshold;
  return scene;
}

scene::BodySpec ball(const std::string& name, double mass, double radius, const Vector3d& position,
                     const Vector3d& velocity, double restitution) {
  scene::BodySpec body;
  body.name = name;
  body.shape = scene::SphereSpec{radius};
  body.mass_kg = mass;
  body.position_m = position;
  body.velocity_m_s = velocity;
  body.restitution = restitution;
  return body;
}

scene::BodySpec point_mass(const std::string& name, double mass, const Vector3d& position,
                           const Vector3d& velocity) {
  const double radius_m = 0.01;  // has no effect: nothing collides
  scene::BodySpec body = ball(name, mass, radius_m, position, velocity, 1.0);
  body.collides = false;
  return body;
}

scene::Scene straight_chain(const std::vector<double>& masses, double length,
                            const Vector3d& direction, const Vector3d& gravity) {
  scene::Scene scene = empty_scene("chain", 1.0, 1e-9);
  scene::EntryWriter{scene}("gravity_m_s2", gravity);
  scene.stabilisation = scene::StabilisationSpec{};
  std::string above;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const std::string bob = "bob" + std::to_string(i);
    scene.bodies.push_back(point_mass(
        bob, masses[i], length * static_cast<double>(i + 1) * direction, Vector3d::Zero()));
    scene::EntryWriter{scene}("rods", {{"name", "rod" + std::to_string(i)},
                                       {"a", scene::AnchorSpec{above}},
                                       {"b", scene::AnchorSpec{bob}},
                                       {"length_m", length}});
    above = bob;
  }
  return scene;
}

scene::BodySpec wall(const std::string& name, const Vector3d& position, const Vector3d& normal,
                     double restitution) {
  scene::BodySpec body;
  body.name = name;
  body.shape = scene::PlaneSpec{};
  body.immovable = true;
  body.position_m = position;
  body.world_from_body = shortest_turn(Vector3d::UnitZ(), normal);
  body.restitution = restitution;
  return body;
}

Trajectory run_in_memory(const scene::Scene& scene, const Laws& laws, double frame_rate_hz) {
  engines::RunOptions options;
  options.frame_rate_hz = frame_rate_hz;
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws, options, recorder);
  if (!recorder.trajectory().stopped_by.empty())
    throw std::runtime_error("the run was stopped: " + recorder.trajectory().stopped_by);
  return recorder.trajectory();
}

SteppedScene in_equal_steps(const scene::Scene& scene, double t, long steps, long frames) {
  // The last frame is at the rounded frames / rate. The last step must end there, not a rounding
  // earlier.
  const double rate = static_cast<double>(frames) / t, end = static_cast<double>(frames) / rate;
  SteppedScene stepped{scene, rate};
  stepped.scene.duration_s = end;
  stepped.scene.step_s = end / static_cast<double>(steps);
  while (static_cast<double>(steps) * stepped.scene.step_s < end)
    stepped.scene.step_s =
        std::nextafter(stepped.scene.step_s, std::numeric_limits<double>::infinity());
  return stepped;
}

Trajectory run_in_steps(const scene::Scene& scene, const Laws& laws, double t, long steps,
                        long frames) {
  const SteppedScene stepped = in_equal_steps(scene, t, steps, frames);
  return run_in_memory(stepped.scene, laws, stepped.frame_rate_hz);
}

Frame frame_at(const scene::Scene& scene, const Laws& laws, double t) {
  scene::Scene shorter = scene;
  const double rate = 1.0 / t;
  shorter.duration_s = std::max(t, 1.0 / rate);  // the frame is at the rounded 1 / rate
  return run_in_memory(shorter, laws, rate).frames.back();
}

Frame start_of(const scene::Scene& scene, const Laws& laws) {
  scene::Scene shorter = scene;
  shorter.step_s = shorter.duration_s = 1e-9;  // s: one step, whose end is not used
  return run_in_memory(shorter, laws, 1.0).frames.front();
}

std::vector<Event> impacts_of(const Trajectory& run) {
  std::vector<Event> impacts;
  std::copy_if(run.events.begin(), run.events.end(), std::back_inserter(impacts),
               [](const Event& event) { return event.kind == EventKind::kCollision; });
  return impacts;
}

}  // namespace tumble::truths
