#include "framework/engines/stepping/link_forces.h"

#include <cstddef>
#include <utility>

#include "framework/effects/registry.h"

namespace tumble::engines {

LinkForces::LinkForces(const World& world) {
  for (const effects::Effect* effect : effects::all())
    of_effects.emplace_back(effect->measured_as() == nullptr ? 0 : effect->count_in(world));
}

void record(LinkForces forces, Frame& frame) {
  for (std::size_t k = 0; k < forces.of_effects.size(); ++k)
    if (const auto kept = effects::all()[k]->measured_as())
      frame.*kept = std::move(forces.of_effects[k]);
}

LinkForces recorded_forces(const World& world, const Frame& frame) {
  LinkForces forces(world);
  for (std::size_t k = 0; k < forces.of_effects.size(); ++k)
    if (const auto kept = effects::all()[k]->measured_as()) forces.of_effects[k] = frame.*kept;
  return forces;
}

}  // namespace tumble::engines
