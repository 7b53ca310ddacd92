#include "framework/grading/grades/shard.h"

#include <algorithm>
#include <regex>

#include "framework/core/error.h"
#include "framework/grading/grades/output_folder.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

std::string name_of(const Shard& shard) {
  return std::to_string(shard.number) + "-of-" + std::to_string(shard.of);
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> all;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    all.push_back(it->path());
  std::sort(all.begin(), all.end());
  return all;
}

bool is_folder(const fs::path& path) {
  std::error_code failed;
  return fs::is_directory(fs::symlink_status(path, failed));
}

// Calls `tell` with each result in a shard's folder. A directory says itself what its entries are.
template <class Tell>
void for_each_result(const fs::path& shard, const Tell& tell) {
  std::error_code failed;
  for (fs::directory_iterator it(shard, failed), end; !failed && it != end; it.increment(failed)) {
    std::error_code gone;
    const bool is_result = it->path().filename().string().front() != '.' && !it->is_symlink(gone) &&
                           it->is_directory(gone);
    if (is_result) tell(it->path());
  }
}

}  // namespace

fs::path shards_folder(const fs::path& out) { return out / kShards; }

fs::path shard_folder(const fs::path& out, const Shard& shard) {
  return shards_folder(out) / name_of(shard);
}

fs::path done_file(const fs::path& out, const Shard& shard) {
  return shards_folder(out) / (name_of(shard) + ".done");
}

std::vector<fs::path> shard_folders(const fs::path& out) {
  static const std::regex form("[0-9]+-of-[0-9]+");
  std::vector<fs::path> all;
  for (const fs::path& entry : entries_of(shards_folder(out)))
    if (is_folder(entry) && std::regex_match(entry.filename().string(), form)) all.push_back(entry);
  return all;
}

FinishedByShards finished_by_shards(const fs::path& out) {
  FinishedByShards finished;
  for (const fs::path& shard : shard_folders(out))
    for_each_result(
        shard, [&](const fs::path& made) { finished[made.filename().string()].push_back(made); });
  return finished;
}

std::size_t finished_in_shards(const fs::path& out) {
  std::size_t count = 0;
  for (const fs::path& shard : shard_folders(out))
    for_each_result(shard, [&](const fs::path&) { ++count; });
  return count;
}

void remove_shards(const fs::path& out) {
  static const std::regex ours("[0-9]+-of-[0-9]+\\.done|log-[0-9]+\\.txt|job\\.(sh|id|log)");
  std::error_code ignored;
  for (const fs::path& shard : shard_folders(out)) remove_results(shard);
  for (const fs::path& entry : entries_of(shards_folder(out)))
    if (!is_folder(entry) && std::regex_match(entry.filename().string(), ours))
      fs::remove(entry, ignored);
  fs::remove(shards_folder(out), ignored);  // only when it is empty
}

}  // namespace tumble::grading
