#include "framework/grading/grades/grade_shards.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/grading/course/machine_key.h"
#include "framework/grading/grades/shard.h"

namespace tumble::grading {

namespace fs = std::filesystem;

void grade_on(const ShardedGrading& grading) {
  machine_key();  // made now, by one process
  const std::string key = machine_key_file().string();
  farm::ClusterJob job;
  job.cluster = grading.cluster;
  job.name = "tumble-grade";
  job.command = grading.command;
  job.needed = {grading.command.front(), grading.root.string(), grading.submissions.string(),
                grading.out.string(), key};
  job.environment = {{"TUMBLE_ROOT", grading.root.string()}, {"TUMBLE_GRADER_KEY", key}};
  job.folder = shards_folder(grading.out);
  job.unit = "submission";
  job.total = grading.total;
  job.shards = grading.shards;
  job.unasked = 10;
  job.hosts = grading.hosts;
  job.jobs = grading.jobs;
  job.finished = [&] { return finished_in_shards(grading.out); };
  job.is_done = [&](const Shard& shard) { return fs::exists(done_file(grading.out, shard)); };
  job.begin = [&](const Shard& shard) {
    std::error_code ignored;
    fs::remove(done_file(grading.out, shard), ignored);
  };
  if (grading.progress)
    job.progress = [&](std::size_t done, std::size_t all, double seconds_left) {
      grading.progress({done, all, "", seconds_left});
    };
  job.notice = grading.notice;
  const std::vector<farm::LostShard> lost = farm::run_on(job);
  if (lost.empty() || !grading.notice) return;
  constexpr std::size_t kNamed = 5;
  for (std::size_t i = 0; i < std::min(kNamed, lost.size()); ++i)
    grading.notice(fmt::format("shard {} of {} did not come to its end: {}", lost[i].shard.number,
                               lost[i].shard.of, lost[i].said));
  grading.notice("what these shards did not finish is graded by this process");
}

}  // namespace tumble::grading
