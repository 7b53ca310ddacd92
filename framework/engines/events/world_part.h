/// A part of a world: the bodies of one process, what acts on them, and the immovable ones they have to do with.
#pragma once

#include <vector>

#include "framework/dynamics/world.h"

namespace tumble::engines {

/// Which entries of a world name a body: found once, so that each part costs what it holds and not what the world does.
class EntriesByBody {
 public:
  explicit EntriesByBody(const World& whole);

 private:
  friend struct PartMaker;
  using Places = std::vector<std::vector<int>>;   // by body: indices, ascending
  std::vector<Places> effects_;                   // by place in effects::all(); empty of those that do not act in this world
  Places apart_;
};

struct WorldPart {
  World world;
  std::vector<int> bodies;          // by body of the part: its index in the whole, ascending
  std::vector<int> members;         // by member (in the order they were asked for): its index in the part
  std::vector<std::vector<int>> entries;   // by place in effects::all() and by entry of the part: its index in the whole
};

/// @param entries  of this very world
/// @param members  movable bodies, ascending, with everything that an effect ties to them
/// @param still    immovable bodies to take in besides those that entries of members name
/// @post of the pairs that do not collide those with a member are there: two that are immovable never do
/// @post solids of the part are points: whoever moves it has the whole's solids
WorldPart part_of(const World& whole, const EntriesByBody& entries, const std::vector<int>& members, const std::vector<int>& still);

}  // namespace tumble::engines
