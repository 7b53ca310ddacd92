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
  effects::EnergySum potential;
  for (const effects::Effect* effect : effects::all())
    effect->add_potential_energy(world, states, potential);
  sums.potential_energy = potential.whole();
  return sums;
}

void sum_energy(const World& world, const std::vector<RigidBodyState>& states,
                EnergyByBody& energy) {
  energy.kinetic = energy.potential = 0.0;
  energy.at_work.assign(world.bodies.size(), 0.0);
  energy.height = energy.at_work;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].immovable()) continue;
    energy.at_work[i] = kinetic_energy(states[i], world.bodies[i].inertia);
    energy.kinetic += energy.at_work[i];
  }
  for (const effects::Effect* effect : effects::all()) {
    effects::EnergySum potential(effect->traits().stores_energy ? energy.at_work : energy.height);
    effect->add_potential_energy(world, states, potential);
    energy.potential += potential.whole();
  }
}

}  // namespace tumble
