#include "framework/engines/stepping/linked_groups.h"

#include <utility>

#include "framework/core/disjoint_sets.h"
#include "framework/effects/registry.h"

namespace tumble::engines {

std::vector<LinkedGroup> groups_of_linked_bodies(const World& world) {
  const int n = static_cast<int>(world.bodies.size());
  DisjointSets sets(n);
  std::vector<bool> linked(n, false);
  const auto movable = [&](int body) { return body >= 0 && !world.bodies[body].immovable(); };
  // Entry by entry: the first movable body that it names, to which it ties the others; -1 where
  // none can move.
  std::vector<std::pair<std::size_t, std::vector<int>>> first_bodies;  // of an effect's entries
  for (std::size_t k = 0; k < effects::all().size(); ++k) {
    const effects::Effect& effect = *effects::all()[k];
    if (!effect.traits().ties || effect.count_in(world) == 0) continue;
    std::vector<int>& first_of = first_bodies.emplace_back(k, std::vector<int>{}).second;
    for (int entry = 0; entry < effect.count_in(world); ++entry) {
      int first = -1;
      for (const int body : effect.bodies_of(world, entry)) {
        if (!movable(body)) continue;
        linked[body] = true;
        if (first < 0) first = body;
        sets.unite(first, body);
      }
      first_of.push_back(first);
    }
  }
  std::vector<int> group_of(n, -1);  // by the name of a set
  std::vector<LinkedGroup> groups;
  for (int i = 0; i < n; ++i) {
    if (!linked[i]) continue;
    int& group = group_of[sets.find(i)];
    if (group < 0) {
      group = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    groups[group].bodies.push_back(i);
  }
  for (const auto& [effect, first_of] : first_bodies)
    for (std::size_t entry = 0; entry < first_of.size(); ++entry)
      if (first_of[entry] >= 0)
        groups[group_of[sets.find(first_of[entry])]].entries[effect].push_back(
            static_cast<int>(entry));
  return groups;
}

}  // namespace tumble::engines
