/// The work of a scheduler per committed event: a scene run by timewarp on its decisions, with
/// counters.
///
/// A scheduler is right or wrong at any step: it must commit the events of the ordered reference,
/// to the last bit, whatever it rolls back. So its error is the fraction of the reference's events
/// that it does not commit, and its cost is the work per committed event. Both are counts, which
/// are the same on any machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/engines/run.h"

namespace tumble::cost {

/// One run of one scene.
struct SchedulerRun {
  int n = 0;                  // of a scene with a size; 0: none
  double step_s = kUnset;     // of a process's advance [s]
  std::size_t processes = 0;  // movable bodies
  // events of the ordered reference; of these committed, in order
  std::size_t due = 0, committed = 0;
  std::uint64_t integrations = 0, undone = 0;  // undone: integrations that were rolled back
  std::uint64_t rollbacks = 0;                 // bodies rolled back, once for each rollback
  std::uint64_t impacts = 0;                   // executed, committed or not
  // anti_messages: k - 1 for each event of k processes that is rolled back
  std::uint64_t anti_messages = 0, checks = 0;
  std::uint64_t states_kept = 0;  // the largest number at any time
  double cpu_s = kUnset;          // of the engine, without the reference run
  std::string stopped_by;         // empty: ran to the end
  bool not_attempted = false;     // a decision that it needs is a stub: stopped_by names it

  bool is_right() const { return stopped_by.empty() && committed == due; }
  /// Fraction of the reference's events that is not committed [-].
  double error() const {
    return due == 0 ? (is_right() ? 0.0 : 1.0)
                    : 1.0 - static_cast<double>(committed) / static_cast<double>(due);
  }
  /// A count per committed event [-]; NaN where there is none.
  double per_event(std::uint64_t count) const {
    return committed == 0 ? kUnset : static_cast<double>(count) / static_cast<double>(committed);
  }
};

/// A scheduler, or an engine for comparison, over its runs.
struct SchedulerCurve {
  std::string name;  // "your scheduler"
  bool is_reference = false;
  std::vector<SchedulerRun> by_step, by_size;
};

/// Options of a run.
struct SchedulerRunOptions {
  double step_s = kUnset;      // [s]; NaN: the scene's
  double duration_s = kUnset;  // [s]; NaN: the scene's
  std::string engine = "tw";   // with `scheduling` in the laws: on its decisions
  engines::Engine timewarp;    // the engine of tw without it
  int n = 0;                   // for the record
  int runs = 1;                // of a short run: the least CPU time counts
  // CPU time after which a run is stopped
  double most_s = std::numeric_limits<double>::infinity();
};

/// @param due  events that the ordered reference commits, from events_due
/// @throws UserError where the scene has an effect that flights do not model
SchedulerRun run_scheduler(const scene::Scene& scene, const Laws& laws,
                           const SchedulerRunOptions& trial, std::size_t due);
std::size_t events_due(const scene::Scene& scene, const Laws& laws,
                       const SchedulerRunOptions& trial);

/// Steps for a scene, long to short. [s]
std::vector<double> scheduler_steps(const scene::Scene& scene);

/// A sentence and its meaning.
struct SchedulerReading {
  enum class Kind { kRight, kWasteful, kWrong, kNotWritten };
  std::string text;
  Kind kind;
};

/// Whether the scheduler is right, and its work: relative to the reference where there is one, else
/// absolute.
/// @param reference  over the same scenes and steps; nullptr: none
std::vector<SchedulerReading> read_scheduler(const SchedulerCurve& curve,
                                             const SchedulerCurve* reference);

}  // namespace tumble::cost
