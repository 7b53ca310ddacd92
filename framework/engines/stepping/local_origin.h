/// Scenes that play far from the world's origin are run in coordinates near them, so that nothing
/// is lost but the rounding of what is given and of what is recorded. A place of 1e6 m is rounded
/// by up to 6e-11 m; added up step by step, and always to the same side as long as the velocity
/// stays, that comes to 1e-9 m before the first collision, and each that turns an edge against an
/// edge makes it some thirty times larger.
#pragma once

#include "framework/scene/scene.h"
#include "framework/trajectory/passing_sink.h"

namespace tumble::engines {

/// A place among the bodies, and what they hang from, from which their places are exact
/// differences; zero where the scene stands near the world's origin. [m]
Vector3d local_origin(const scene::Scene& scene);

/// The same scene, seen from there; a place of up to 15 decimal digits means that decimal, and not
/// the nearest double, where no spring and no rod spans from one to another.
scene::Scene seen_from(const Vector3d& origin_world, scene::Scene scene);

/// Passes a run that was made in local coordinates on in those of the world.
class WorldSink final : public PassingSink {
 public:
  /// @param mass  of all movable bodies together [kg]
  WorldSink(TrajectorySink& sink, const Vector3d& origin_world, double mass,
            const Vector3d& gravity_world)
      : PassingSink(sink),
        origin_world_(origin_world),
        potential_energy_(-mass * gravity_world.dot(origin_world)) {}

  void frame(const Frame& frame) override;
  void event(const Event& event) override;

 private:
  Vector3d origin_world_;
  double potential_energy_;  // of the whole at the origin [J]
};

}  // namespace tumble::engines
