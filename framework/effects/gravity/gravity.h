/// Gravity: the same acceleration for every body.
///   F = m g,    E = -m g . x        (x: the centre of mass, world frame)
#pragma once

#include <optional>
#include <string>

#include "framework/scene/scene.h"

namespace tumble::effects {

/// What a scene says of it, at most once. A world holds it as World::gravity_world.
struct GravitySpec {
  Vector3d acceleration_m_s2;
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// Of a scene that is made in memory.
inline void set_gravity(scene::Scene& scene, const Vector3d& acceleration_m_s2) {
  scene.effects.of<GravitySpec>() = {{acceleration_m_s2}};
}
inline std::optional<Vector3d> gravity_of(const scene::Scene& scene) {
  const auto& said = scene.effects.of<GravitySpec>();
  return said.empty() ? std::nullopt : std::optional(said.front().acceleration_m_s2);
}

}  // namespace tumble::effects
