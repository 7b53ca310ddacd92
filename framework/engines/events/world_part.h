/// A part of a world: the bodies of one process, the effects on them, and the immovable bodies that
/// these name or touch.
#pragma once

#include <vector>

#include "framework/dynamics/world.h"

namespace tumble::engines {

/// The entries of a world by the bodies that they name. Computed once, so that a part costs by its
/// own size and not by that of the world.
class EntriesByBody {
 public:
  explicit EntriesByBody(const World& whole);

 private:
  friend struct PartMaker;
  using Places = std::vector<std::vector<int>>;  // by body: indices, ascending
  // by index in effects::all(); empty for effects that do not act in this world
  std::vector<Places> effects_;
  Places apart_;
};

struct WorldPart {
  World world;
  std::vector<int> bodies;  // by body of the part: its index in the whole world, ascending
  // by member, in the order of the argument: its index in the part
  std::vector<int> members;
  // by index in effects::all() and by entry of the part: its index in the whole world
  std::vector<std::vector<int>> entries;
};

/// @param entries  of this world
/// @param members  movable bodies, ascending, with all bodies that an effect couples to them
/// @param still    immovable bodies to include besides those that entries of members name
/// @post pairs that do not collide are included where one body is a member: two immovable bodies
///   never collide
/// @post shapes of the part are points: the caller has the shapes of the whole world
WorldPart part_of(const World& whole, const EntriesByBody& entries, const std::vector<int>& members,
                  const std::vector<int>& still);

}  // namespace tumble::engines
