#include "framework/effects/invariants.h"

#include "framework/effects/registry.h"

namespace tumble {

Invariants invariants_of(const World& world, const std::vector<RigidBodyState>& states) {
  Invariants sums;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const WorldBody& body = world.bodies[i];
    if (body.immovable()) continue;
    const RigidBodyState& state = states[i];
    sums.kinetic_energy += kinetic_energy(state, body.inertia);
    sums.momentum_world += state.momentum_world;
    sums.angular_momentum_world +=
        state.angular_momentum_world + state.com_world.cross(state.momentum_world);
  }
  for (const effects::Effect* effect : effects::all())
    effect->add_potential_energy(world, states, sums.potential_energy);
  return sums;
}

}  // namespace tumble
