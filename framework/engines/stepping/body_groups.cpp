#include "framework/engines/stepping/body_groups.h"

#include "framework/core/disjoint_sets.h"

namespace tumble::engines {

std::vector<int> group_leaders(const MovingWorld& moving,
                               const std::vector<std::pair<int, int>>& touching) {
  DisjointSets sets(moving.size());
  for (const LinkedBodies& linked : moving.linked_groups())
    for (const int body : linked.bodies()) sets.unite(linked.bodies().front(), body);
  for (const auto& [a, b] : touching)
    if (moving.can_move(a) && moving.can_move(b)) sets.unite(a, b);
  std::vector<int> leader;
  for (int i = 0; i < moving.size(); ++i) leader.push_back(sets.find(i));
  return leader;
}

}  // namespace tumble::engines
