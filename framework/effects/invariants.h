/// Energy, momentum and angular momentum of a world.
#pragma once

#include <vector>

#include "framework/dynamics/world.h"

namespace tumble {

/// Sums over the movable bodies of a world.
struct Invariants {
  double kinetic_energy = 0.0;                         // [J]
  double potential_energy = 0.0;                       // of all effects [J]
  Vector3d momentum_world = Vector3d::Zero();          // [kg m/s]
  Vector3d angular_momentum_world = Vector3d::Zero();  // about the world's origin [kg m^2/s]
};
/// @param states  by body index; of immovable bodies the place alone is looked at, for what ends
/// there
Invariants invariants_of(const World& world, const std::vector<RigidBodyState>& states);

/// The energy of each body of a world; 0 of what does not move.
struct EnergyByBody {
  double kinetic = 0.0, potential = 0.0;  // the sums [J]
  // by body: what moves, and what effects have stored that give it back; what is left of the
  // potential energy. What is stored between two bodies is either's. [J]
  std::vector<double> at_work, height;
};
/// @param energy  of these states afterwards; one that is kept is asked at every step without a new
/// place for its lists
void sum_energy(const World& world, const std::vector<RigidBodyState>& states,
                EnergyByBody& energy);

}  // namespace tumble
