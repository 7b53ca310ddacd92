#include "framework/engines/stepping/body_groups.h"

#include <algorithm>
#include <numeric>

namespace tumble::engines {

std::vector<int> group_leaders(const MovingWorld& moving, const std::vector<std::pair<int, int>>& touching) {
  std::vector<int> leader(moving.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  const auto join = [&](int a, int b) {
    const int i = find(a), j = find(b);
    leader[std::max(i, j)] = std::min(i, j);
  };
  for (const LinkedBodies& linked : moving.linked_groups())
    for (const int body : linked.bodies()) join(linked.bodies().front(), body);
  for (const auto& [a, b] : touching)
    if (moving.can_move(a) && moving.can_move(b)) join(a, b);
  for (int i = 0; i < moving.size(); ++i) leader[i] = find(i);
  return leader;
}

}  // namespace tumble::engines
