/// A shard (farm/shard.h) of a class: a part of it that is graded by itself, perhaps on another
/// machine. A grading of the whole class takes over what shards have finished, as if it had graded
/// it.
///
///   OUT/.shards/2-of-8/       results of the second of eight: an output folder (output_folder.h)
///   OUT/.shards/2-of-8.done   that shard has come to its end; how many it graded
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/farm/shard.h"

namespace tumble::grading {

using farm::Shard;

/// OUT/.shards
std::filesystem::path shards_folder(const std::filesystem::path& out);
/// OUT/.shards/2-of-8
std::filesystem::path shard_folder(const std::filesystem::path& out, const Shard& shard);
/// OUT/.shards/2-of-8.done
std::filesystem::path done_file(const std::filesystem::path& out, const Shard& shard);

/// Every folder of results in OUT/.shards, whatever number of shards it is of, by name.
std::vector<std::filesystem::path> shard_folders(const std::filesystem::path& out);

/// By the folder of a submission, where shards of OUT have left a result of it.
using FinishedByShards = std::map<std::string, std::vector<std::filesystem::path>>;
/// Each folder is listed once, and no entry is looked at by itself: a class may have 10^5
/// submissions in 10^3 shards on a file server.
FinishedByShards finished_by_shards(const std::filesystem::path& out);

/// How many results shards of OUT have finished so far.
std::size_t finished_in_shards(const std::filesystem::path& out);

/// Removes what is left in OUT/.shards when everything has been taken over: only files that shards
/// and jobs write; any other file stays, and its folders with it.
void remove_shards(const std::filesystem::path& out);

}  // namespace tumble::grading
