#include "framework/engines/base/rest_speed.h"

#include <algorithm>
#include <cmath>

#include "framework/core/numbers.h"
#include "framework/effects/build_world.h"

namespace tumble::engines {

double rest_speed_of(const scene::Scene& scene) {
  constexpr double kPartOfSpeed = 1e-2;  // of the fastest, where nothing falls
  if (scene.gives_rest_speed) return scene.rest_speed_m_s;
  const World world = build_world(scene);
  const double g = world.gravity_world ? world.gravity_world->norm() : 0.0;
  double least_radius = kInfinity, fastest = 0.0;  // [m], [m/s]
  for (const WorldBody& body : world.bodies) {
    if (body.immovable() || !body.collides) continue;
    const double radius = bounding_radius(body.shape);
    const Vector3d omega = omega_of(body.state, body.inertia);
    least_radius = std::min(least_radius, radius);
    fastest = std::max(fastest, body.inertia.inverse_mass * body.state.momentum_world.norm() +
                                    omega.norm() * radius);
  }
  double least = kInfinity;
  if (g > 0.0 && least_radius > 0.0)
    least = std::sqrt(2.0 * g * kLastBounceOfRadius * least_radius);
  else if (g == 0.0 && fastest > 0.0)
    least = kPartOfSpeed * fastest;
  return std::min(scene.rest_speed_m_s, least);
}

}  // namespace tumble::engines
