/// What links pull with, and where a frame keeps it.
#pragma once

#include <vector>

#include "framework/dynamics/world.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// What the links of a world pull with, by their places in its lists; zero for links of other
/// groups. [N]
struct LinkForces {
  explicit LinkForces(const World& world);

  // by place in effects::all(); empty of those that are not recorded
  std::vector<std::vector<double>> of_effects;
};
/// Puts them where a frame keeps them.
void record(LinkForces forces, Frame& frame);
/// What a frame keeps of them.
LinkForces recorded_forces(const World& world, const Frame& frame);

}  // namespace tumble::engines
