/// Scenes made in memory, run by the engine with the laws chosen: what truths about whole runs stand on.
#pragma once

#include "framework/engines/run.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::truths {

/// A scene without bodies: no gravity, the engine's usual step.
/// @param rest_speed  impacts that separate more slowly end in rest [m/s]
scene::Scene empty_scene(const std::string& name, double duration, double restitution_threshold);

scene::BodySpec ball(const std::string& name, double mass, double radius, const Vector3d& position, const Vector3d& velocity, double restitution);
/// Immovable half-space below a plane. @param normal  unit, world, out of the solid
scene::BodySpec wall(const std::string& name, const Vector3d& position, const Vector3d& normal, double restitution);

/// A body that nothing touches and that springs and rods hold at its centre, so that its inertia does not matter.
scene::BodySpec point_mass(const std::string& name, double mass, const Vector3d& position, const Vector3d& velocity);

/// Point masses on rods, each hung on the one before, the first on the world's origin; under gravity, places kept by projection.
/// @param direction  unit, along the chain  @param length  of each rod [m]
scene::Scene straight_chain(const std::vector<double>& masses, double length, const Vector3d& direction, const Vector3d& gravity);

/// The whole run; `frame_rate_hz` as small as wanted where only events matter.
/// @throws UserError as run_scene; std::runtime_error when the run was stopped early
Trajectory run_in_memory(const scene::Scene& scene, const Laws& laws, double frame_rate_hz);

/// A run to t of equal steps with equally many or fewer frames, each of which falls on the end of a step: what it shows is a state, while a
/// frame within a step stands on a path through the step's ends. @pre frames divides steps
Trajectory run_in_steps(const scene::Scene& scene, const Laws& laws, double t, long steps, long frames);

/// What run_in_steps runs: the scene cut into equal steps, and the rate of frames that fall on their ends.
struct SteppedScene {
  scene::Scene scene;
  double frame_rate_hz;
};
SteppedScene in_equal_steps(const scene::Scene& scene, double t, long steps, long frames);

/// All bodies at one instant of the run: a run that ends there. @param t  [s], > 0
Frame frame_at(const scene::Scene& scene, const Laws& laws, double t);

/// All bodies at the start.
Frame start_of(const scene::Scene& scene, const Laws& laws);

/// Impacts of a run, in order: rest and forces left out.
std::vector<Event> impacts_of(const Trajectory& run);

}  // namespace tumble::truths
