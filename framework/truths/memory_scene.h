/// Scenes made in memory and run by the engine with the chosen laws, for comparisons of whole runs.
#pragma once

#include "framework/engines/run.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::truths {

/// A scene without bodies: no gravity, the engine's usual step.
/// @param rest_speed  impacts that separate more slowly end in rest [m/s]
scene::Scene empty_scene(const std::string& name, double duration, double restitution_threshold);

scene::BodySpec ball(const std::string& name, double mass, double radius, const Vector3d& position,
                     const Vector3d& velocity, double restitution);
/// Immovable half-space below a plane. @param normal  unit, world, out of the solid
scene::BodySpec wall(const std::string& name, const Vector3d& position, const Vector3d& normal,
                     double restitution);

/// A body without contacts, held by springs and rods at its centre, so that its inertia has no
/// effect.
scene::BodySpec point_mass(const std::string& name, double mass, const Vector3d& position,
                           const Vector3d& velocity);

/// Point masses on rods, each attached to the one before, the first to the world's origin; with
/// gravity, constraints kept by projection.
/// @param direction  unit, along the chain  @param length  of each rod [m]
scene::Scene straight_chain(const std::vector<double>& masses, double length,
                            const Vector3d& direction, const Vector3d& gravity);

/// The whole run; `frame_rate_hz` may be small where only events are used.
/// @throws UserError as run_scene; std::runtime_error when the run was stopped early
Trajectory run_in_memory(const scene::Scene& scene, const Laws& laws, double frame_rate_hz);

/// A run to t of equal steps with at most as many frames, each at the end of a step: such a frame
/// is a state, while a frame within a step is interpolated. @pre frames divides steps
Trajectory run_in_steps(const scene::Scene& scene, const Laws& laws, double t, long steps,
                        long frames);

/// The scene of run_in_steps, cut into equal steps, and the rate of frames at their ends.
struct SteppedScene {
  scene::Scene scene;
  double frame_rate_hz;
};
SteppedScene in_equal_steps(const scene::Scene& scene, double t, long steps, long frames);

/// All bodies at time t, by a run that ends there. @param t  [s], > 0
Frame frame_at(const scene::Scene& scene, const Laws& laws, double t);

/// All bodies at the start.
Frame start_of(const scene::Scene& scene, const Laws& laws);

/// Impacts of a run in order, without transitions to rest and forces.
std::vector<Event> impacts_of(const Trajectory& run);

}  // namespace tumble::truths
