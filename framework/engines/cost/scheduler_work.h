/// What a scheduler pays for what it commits: a scene run by timewarp on its decisions, counted.
///
/// A scheduler is right or wrong at any step: whatever it takes back, it must commit the events of the ordered reference, to the last bit.
/// So its error is the part of the reference's events that it does not commit, and its price is the work for each event that it does.
/// Both are counts, which are the same on any machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/engines/run.h"

namespace tumble::engines {

/// One run of one scene.
struct SchedulerRun {
  int n = 0;                          // of a scene with a size; 0: it has none
  double step_s = kUnset;             // how far a process goes ahead at a time [s]
  std::size_t processes = 0;          // bodies that move
  std::size_t due = 0, committed = 0; // events of the ordered reference; of these committed, in order
  std::uint64_t integrations = 0, undone = 0;   // undone: integrations that were taken back
  std::uint64_t rollbacks = 0;        // bodies sent back, each as often as it was
  std::uint64_t impacts = 0;          // worked at, whatever became of them
  std::uint64_t anti_messages = 0, checks = 0;
  std::uint64_t states_kept = 0;      // the most at any time
  double cpu_s = kUnset;              // of the engine, without the reference that it is compared with
  std::string stopped_by;             // empty: it came to the end
  bool not_attempted = false;         // a decision that it asks for is a stub: stopped_by says which

  bool is_right() const { return stopped_by.empty() && committed == due; }
  /// Part of the reference's events that is not committed [-].
  double error() const { return due == 0 ? (is_right() ? 0.0 : 1.0) : 1.0 - static_cast<double>(committed) / static_cast<double>(due); }
  /// A count for each committed event [-]; NaN where there is none.
  double per_event(std::uint64_t count) const { return committed == 0 ? kUnset : static_cast<double>(count) / static_cast<double>(committed); }
};

/// A scheduler, or an engine beside it, over its runs.
struct SchedulerCurve {
  std::string name;                   // "your scheduler"
  bool is_reference = false;
  std::vector<SchedulerRun> by_step, by_size;
};

/// How a run is made.
struct SchedulerTrial {
  double step_s = kUnset;             // [s]; NaN: the scene's
  double duration_s = kUnset;         // [s]; NaN: the scene's
  std::string engine = "tw";          // with `scheduling` in the laws: on its decisions
  Engine timewarp;                    // what tw is without it
  int n = 0;                          // for the record
  int runs = 1;                       // of a short one: the least CPU time counts
  double most_s = std::numeric_limits<double>::infinity();   // CPU after which a run is stopped
};

/// @param due  events that the ordered reference commits, from events_due
/// @throws UserError where the scene has what no flight follows
SchedulerRun run_scheduler(const scene::Scene& scene, const Laws& laws, const SchedulerTrial& trial, std::size_t due);
std::size_t events_due(const scene::Scene& scene, const Laws& laws, const SchedulerTrial& trial);

/// Steps of a ladder for a scene, long to short. [s]
std::vector<double> scheduler_steps(const scene::Scene& scene);

/// A sentence, and what it means.
struct SchedulerReading {
  enum class Kind { kRight, kWasteful, kWrong, kNotWritten };
  std::string text;
  Kind kind;
};

/// Whether it is right, and what it pays: beside the reference where there is one, else in its own numbers.
/// @param reference  run over the same scenes and steps; nullptr: none
std::vector<SchedulerReading> read_scheduler(const SchedulerCurve& curve, const SchedulerCurve* reference);

}  // namespace tumble::engines
