/// Which bodies of a world move together because effects tie them to each other.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "framework/dynamics/world.h"

namespace tumble::engines {

/// Movable bodies that entries of effects tie together, and these entries.
struct LinkedGroup {
  std::vector<int> bodies;  // ascending
  // by place in effects::all(); ascending, one at least
  std::map<std::size_t, std::vector<int>> entries;
};
/// The groups of a world, by their first bodies. Bodies that no entry ties or acts on are in none.
/// Cost: linear in bodies and entries.
std::vector<LinkedGroup> groups_of_linked_bodies(const World& world);

}  // namespace tumble::engines
