#include "framework/cli/rest_speed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "framework/effects/build_world.h"
#include "framework/engines/base/rest_speed.h"

namespace tumble::cli {
namespace {

/// Bodies that bounce off another lower each time: of a pair the smaller restitution counts, and
/// with 0 nothing bounces, with 1 nothing is lost.
std::vector<const WorldBody*> lossy_bouncers(const World& world) {
  const auto count = [&](double below) {
    return std::count_if(world.bodies.begin(), world.bodies.end(), [&](const WorldBody& body) {
      return body.collides && body.restitution > 0.0 && body.restitution < below;
    });
  };
  const auto bouncing = count(std::numeric_limits<double>::infinity()), lossy = count(1.0);
  std::vector<const WorldBody*> bodies;
  for (const WorldBody& body : world.bodies)
    if (!body.immovable() && body.collides && body.restitution > 0.0 && bouncing > 1 && lossy > 0)
      bodies.push_back(&body);
  return bodies;
}

}  // namespace

std::string note_of_rest_speed(const scene::Scene& scene) {
  // The height of the last bounce over the body's radius; those of bodies of a metre are 5e-8.
  constexpr double kPartOfSize = 1.01 * engines::kLastBounceOfRadius;  // rounding is no news
  constexpr double kPartOfSpeed = 0.1;
  // of sqrt(g r): that of a model that is dropped (scene/model_scene.cpp)
  constexpr double kRestSpeed = 5e-4;
  const double rest = engines::rest_speed_of(scene);
  const World world = build_world(scene);
  const double g = world.gravity_world ? world.gravity_world->norm() : 0.0;
  for (const WorldBody* bouncer : lossy_bouncers(world)) {
    const WorldBody& body = *bouncer;
    const double radius = bounding_radius(body.shape), height = rest * rest / (2.0 * g),
                 speed = body.inertia.inverse_mass * body.state.momentum_world.norm();
    if (g > 0.0 && radius > 0.0 && height > kPartOfSize * radius)
      return fmt::format(
          "bounces that separate by less than rest_speed_m_s = {:g} m/s end in rest: lower than "
          "{:.2g} m, which is {:.2g} of the radius about '{}'. Of its size: \"rest_speed_m_s\": "
          "{:.1g}",
          rest, height, height / radius, body.name, kRestSpeed * std::sqrt(g * radius));
    if (g == 0.0 && speed > 0.0 && rest > kPartOfSpeed * speed)
      return fmt::format(
          "bounces that separate by less than rest_speed_m_s = {:g} m/s end in rest, and '{}' "
          "begins with {:.2g} m/s. Of its speed: \"rest_speed_m_s\": {:.1g}",
          rest, body.name, speed, kRestSpeed * speed);
  }
  return "";
}

}  // namespace tumble::cli
