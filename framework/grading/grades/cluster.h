/// Grades a class on several machines: its shards (shard.h) are the tasks of an array job of Slurm,
/// or commands that GNU parallel runs over ssh. This file plans nothing itself: the scheduler
/// decides where and when, and repeats what a lost machine did not finish.
///
/// Every machine must see the course, the submissions, OUT and the key that signs records
/// (machine_key.h) under the same paths, as in a shared folder. What is left in OUT/.shards:
///   job.sh      what a task runs
///   job.id      the running job of Slurm, so that a second start waits for it
///   job.log     GNU parallel's list of finished commands
///   log-K.txt   what shard K printed
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

enum class Cluster { kSlurm, kParallel };

/// From "slurm" or "parallel".
/// @throws UserError for other words
Cluster cluster_of(const std::string& word);

struct ClusterJob {
  Cluster cluster = Cluster::kSlurm;
  // `tumble grade ...` with absolute paths and without --shard
  std::vector<std::string> command;
  std::filesystem::path root;         // of the course: TUMBLE_ROOT
  std::filesystem::path submissions;  // absolute, as `out`
  std::filesystem::path out;
  std::size_t total = 0;  // submissions
  int shards = 0;         // 0: ten submissions each, at most 1,000
  std::string hosts;      // for parallel: its words for --sshlogin; empty: this machine
  int per_host = 0;       // for parallel: shards at a time on a host; 0: one a core
  std::function<void(const GradeProgress&)> progress;
  std::function<void(const std::string&)> notice;
};

/// Runs all shards to their end. Those that did not come to their end (a lost node, a time limit of
/// the cluster) are submitted again, as long as a round finishes at least one; `notice` names the
/// others with the last line of their logs.
/// @throws UserError when the scheduler is not there or refuses the job, and when a first round
///   finished no submission at all, with what a task said
void grade_on(const ClusterJob& job);

}  // namespace tumble::grading
