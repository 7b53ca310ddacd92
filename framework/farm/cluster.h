/// Shards of a work on several machines: tasks of an array job of Slurm, commands that GNU parallel
/// runs over ssh, or ranks that Open MPI's mpirun starts. This file plans nothing itself: the
/// scheduler decides where and when, and what a lost machine did not finish is run again.
///
/// The ranks of MPI send each other nothing, for the pieces need nothing of each other: each takes
/// the next shard that no rank has taken, by making a folder in the shared one. A lost rank costs
/// the shard that it had, and no other rank ends (mpirun --enable-recovery).
///
/// Every machine must see the files of the work under the same paths, as in a shared folder. What
/// is left in ClusterJob::folder:
///   job.sh      what a task runs
///   job.id      the running job of Slurm, so that a second start waits for it
///   job.log     GNU parallel's list of finished commands
///   rank.sh     what a rank of MPI runs; taken/K: shard K is a rank's
///   log-K.txt   what shard K printed
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "framework/farm/shard.h"

namespace tumble::farm {

enum class Cluster { kSlurm, kParallel, kMpi };

/// For people: "slurm (an array job), ..."
std::string names_of_clusters();

/// From "slurm", "parallel" or "mpi".
/// @throws UserError for other words
Cluster cluster_of(const std::string& word);

struct ClusterJob {
  Cluster cluster = Cluster::kSlurm;
  std::string name;                  // of the job in the queue: "tumble-grade"
  std::vector<std::string> command;  // of a task, with absolute paths; " --shard K/N" is added
  std::vector<std::string> needed;   // paths that every machine must see
  std::vector<std::pair<std::string, std::string>> environment;  // of a task
  std::filesystem::path directory;                               // in which a task runs; empty: any
  std::filesystem::path folder;                                  // absolute
  std::string unit;  // what there are `total` of: "submission"
  std::size_t total = 0;
  int shards = 0;  // 0: so many that each has `unasked` units, at most 1,000
  std::size_t unasked = 1;
  // for parallel its words for --sshlogin, for MPI for --host; empty: this machine, and for MPI
  // the nodes of the allocation in which it is started
  std::string hosts;
  int jobs = 0;  // shards at a time, for parallel on each host; 0: one a core
  std::function<std::size_t()> finished;            // units that are there
  std::function<bool(const Shard& shard)> is_done;  // it came to its end
  // throws where running it again cannot help; may be empty
  std::function<void(const Shard& shard)> is_refused;
  // called before the first job, not where a job of an earlier start is still running
  std::function<void(const Shard& shard)> begin;
  std::function<void(std::size_t done, std::size_t all, double seconds_left)> progress;
  std::function<void(const std::string&)> notice;
};

/// A shard that did not come to its end, and the last line that it printed.
struct LostShard {
  Shard shard;
  std::string said;
};

/// Runs all shards to their end. Those that did not come to their end (a lost node, a time limit of
/// the cluster) are submitted again, as long as a round finishes at least one.
/// @return the others
/// @throws UserError when the scheduler is not there or refuses the job, and when a first round
///   finished no unit at all, with what a task said
std::vector<LostShard> run_on(const ClusterJob& job);

}  // namespace tumble::farm
