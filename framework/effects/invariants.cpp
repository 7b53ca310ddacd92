#include "framework/effects/invariants.h"

#include "framework/dynamics/anchors.h"

namespace tumble {

Invariants invariants_of(const World& world, const std::vector<RigidBodyState>& states) {
  Invariants sums;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const WorldBody& body = world.bodies[i];
    if (body.immovable()) continue;
    const RigidBodyState& state = states[i];
    sums.kinetic_energy += kinetic_energy(state, body.inertia);
    if (world.gravity_world) sums.potential_energy -= body.inertia.mass * world.gravity_world->dot(state.com_world);
    sums.momentum_world += state.momentum_world;
    sums.angular_momentum_world += state.angular_momentum_world + state.com_world.cross(state.momentum_world);
  }
  for (const SpringLink& link : world.springs) {
    // E = k/2 (L - L0)^2
    const double stretch = (anchor_point(link.b, states) - anchor_point(link.a, states)).norm() - link.spring.rest_length;
    sums.potential_energy += 0.5 * link.spring.stiffness * stretch * stretch;
  }
  return sums;
}

}  // namespace tumble
