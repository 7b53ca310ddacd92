#include "framework/farm/spread.h"

#include <sys/wait.h>

#include <chrono>

#include <fmt/format.h>

#include "framework/farm/processes.h"

namespace tumble::farm {
namespace {

using Clock = std::chrono::steady_clock;

std::string why_of(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("its process was ended by signal {}", WTERMSIG(status));
  return fmt::format("its process ended with code {} and left nothing", WEXITSTATUS(status));
}

}  // namespace

Outcome make_here(const KeptParts& parts, const SplitWork& work, const LocalOptions& options) {
  Outcome outcome;
  std::vector<std::size_t> open;
  std::size_t all = 0;
  for (std::size_t i = 0; i < work.names.size(); ++i) {
    if (options.shard && !options.shard->holds(i)) continue;
    ++all;
    if (parts.has(work.names[i])) {
      ++outcome.taken_over;
    } else {
      parts.forget(work.names[i]);
      open.push_back(i);
    }
  }
  if (!open.empty()) {  // a folder that cannot be written is told now and not after all runs
    parts.put(".probe", "");
    parts.forget(".probe");
  }
  std::vector<int> status_of(open.size(), 0);
  const auto start = Clock::now();
  std::size_t ended = 0;
  run_in_processes(
      open.size(), options.jobs,
      [&](std::size_t k) {
        const std::string& name = work.names[open[k]];
        try {
          parts.put(name, work.make(open[k]));
        } catch (...) {
          parts.put_error(name, std::current_exception());
        }
      },
      [&](std::size_t k, int status, double) {
        status_of[k] = status;
        parts.rethrow_error(work.names[open[k]]);
        ++ended;
        const double spent = std::chrono::duration<double>(Clock::now() - start).count();
        if (options.progress)
          options.progress(
              outcome.taken_over + ended, all,
              spent / static_cast<double>(ended) * static_cast<double>(open.size() - ended));
      });
  for (std::size_t k = 0; k < open.size(); ++k)
    if (!parts.has(work.names[open[k]]))
      outcome.lost.push_back({work.names[open[k]], work.label(open[k]), why_of(status_of[k])});
  return outcome;
}

Outcome make_on(const KeptParts& parts, const SplitWork& work, ClusterJob job) {
  Outcome outcome;
  for (const std::string& name : work.names) {
    if (parts.has(name))
      ++outcome.taken_over;
    else
      parts.forget(name);
  }
  if (outcome.taken_over == work.names.size()) return outcome;
  // asked several times a second: a part that is whole stays, and is read and digested once
  std::vector<bool> is_whole(work.names.size(), false);
  const auto finished = [&] {
    std::size_t count = 0;
    for (std::size_t i = 0; i < work.names.size(); ++i) {
      if (!is_whole[i]) is_whole[i] = parts.has(work.names[i]);
      count += is_whole[i] ? 1 : 0;
    }
    return count;
  };
  const auto each_of = [&](const Shard& shard, const auto& call) {
    for (std::size_t i = 0; i < work.names.size(); ++i)
      if (shard.holds(i)) call(work.names[i]);
  };
  job.folder = std::filesystem::absolute(parts.folder()) / ".job";
  job.unit = work.unit;
  job.total = work.names.size();
  job.finished = finished;
  job.is_done = [&](const Shard& shard) {
    bool is_done = true;
    each_of(shard, [&](const std::string& name) { is_done = is_done && parts.has(name); });
    return is_done;
  };
  job.is_refused = [&](const Shard& shard) {
    each_of(shard, [&](const std::string& name) { parts.rethrow_error(name); });
  };
  const std::vector<LostShard> lost = run_on(job);
  for (std::size_t i = 0; i < work.names.size(); ++i) {
    if (parts.has(work.names[i])) continue;
    std::string why = "its task did not come to its end";
    for (const LostShard& shard : lost)
      if (shard.shard.holds(i) && !shard.said.empty()) why += ": " + shard.said;
    outcome.lost.push_back({work.names[i], work.label(i), why});
  }
  return outcome;
}

}  // namespace tumble::farm
