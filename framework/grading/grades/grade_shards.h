/// Grades a class on several machines: its shards (shard.h) are tasks of a cluster
/// (farm/cluster.h). Every machine must see the course, the submissions, OUT and the key that signs
/// records (machine_key.h) under the same paths. The files of the job lie in OUT/.shards.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/farm/cluster.h"
#include "framework/grading/grades/grade.h"

namespace tumble::grading {

struct ShardedGrading {
  farm::Cluster cluster = farm::Cluster::kSlurm;
  // `tumble grade ...` with absolute paths and without --shard
  std::vector<std::string> command;
  std::filesystem::path root;         // of the course: TUMBLE_ROOT
  std::filesystem::path submissions;  // absolute, as `out`
  std::filesystem::path out;
  std::size_t total = 0;  // submissions
  int shards = 0;         // 0: ten submissions each, at most 1,000
  std::string hosts;      // as farm::ClusterJob's
  int jobs = 0;
  std::function<void(const GradeProgress&)> progress;
  std::function<void(const std::string&)> notice;
};

/// Runs all shards to their end; `notice` names those that did not come to it.
/// @throws UserError as farm::run_on
void grade_on(const ShardedGrading& grading);

}  // namespace tumble::grading
