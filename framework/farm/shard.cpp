#include "framework/farm/shard.h"

#include <regex>

#include "framework/core/error.h"

namespace tumble::farm {

Shard shard_of(const std::string& words) {
  constexpr int kMostShards = 1'000'000;
  static const std::regex form("([0-9]{1,7})/([0-9]{1,7})");
  std::smatch match;
  if (std::regex_match(words, match, form)) {
    const Shard shard{std::stoi(match[1]), std::stoi(match[2])};
    if (shard.number >= 1 && shard.number <= shard.of && shard.of <= kMostShards) return shard;
  }
  throw UserError("--shard", "is '" + words + "'",
                  "The second of eight shards is 2/8; they are counted from 1.");
}

}  // namespace tumble::farm
