/// A shard: a part of a list of independent pieces of work, done by itself, perhaps on another
/// machine.
#pragma once

#include <cstddef>
#include <string>

namespace tumble::farm {

struct Shard {
  int number = 1, of = 1;  // 1 <= number <= of

  /// Whether a piece belongs to it. Neighbours in a list go to different shards, so that work is
  /// spread evenly.
  /// @param index  of the piece in the list
  bool holds(std::size_t index) const {
    return index % static_cast<std::size_t>(of) == static_cast<std::size_t>(number - 1);
  }
};

/// From "2/8".
/// @throws UserError for other words
Shard shard_of(const std::string& words);

}  // namespace tumble::farm
