#include "framework/cost/scheduler_work.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/cpu_time.h"
#include "framework/core/not_implemented.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/cost/cost.h"

namespace tumble::cost {
namespace {

constexpr double kLeast = 1e-6;  // s: of any run
// of a run: a frame brings every process to its time, so few of them leave the scheduler
// undisturbed
constexpr double kFrames = 12.0;
constexpr double kCoarsestWork = 8.0;  // of the scene's own step
constexpr int kSteps = 7;              // halvings

engines::RunOptions options_of(const SchedulerRunOptions& trial, const scene::Scene& scene) {
  engines::RunOptions options;
  options.engine = trial.engine;
  options.timewarp = trial.timewarp;
  if (!std::isnan(trial.step_s)) options.step_s = trial.step_s;
  if (!std::isnan(trial.duration_s)) options.duration_s = trial.duration_s;
  options.frame_rate_hz = kFrames / options.duration_s.value_or(scene.duration_s);
  return options;
}

/// Stops a run that would never end: at a decision of the scheduler.
void stop_when_too_long(double most_s, Laws& laws) {
  if (!laws.scheduling || !std::isfinite(most_s)) return;
  laws.scheduling.on_collision_check =
      [inner = laws.scheduling.on_collision_check, until = cpu_seconds() + most_s, most_s](
          const ScheduledEvent& event, const CheckFinding& finding, double step) {
        if (cpu_seconds() > until)
          throw OutOfTime(fmt::format("it takes more than {:.0f} s", most_s));
        return inner(event, finding, step);
      };
}

/// A run and its CPU time.
class Clocked final : public TrajectorySink {
 public:
  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override {
    recorder.begin(info, bodies);
    begun_ = cpu_seconds();
  }
  void frame(const Frame& frame) override { recorder.frame(frame); }
  void event(const Event& event) override { recorder.event(event); }
  void end(const Counters& counters, const std::string& stopped_by) override {
    cpu_s = cpu_seconds() - begun_;
    recorder.end(counters, stopped_by);
  }
  TrajectoryRecorder recorder;
  double cpu_s = kUnset;

 private:
  double begun_ = 0.0;
};

void count(const Trajectory& recorded, SchedulerRun& run) {
  const auto of = [&](const char* name) {
    const auto found = recorded.counters.counts.find(name);
    return found == recorded.counters.counts.end() ? std::uint64_t{0} : found->second;
  };
  run.committed = recorded.events.size();
  run.stopped_by = recorded.stopped_by;
  run.integrations = of("integrations");
  run.undone = of("undone_integrations");
  run.rollbacks = of("rollbacks");
  run.impacts = of("impacts");
  run.anti_messages = of("anti_messages");
  run.checks = of("pair_checks");
  run.states_kept = of("states_kept");
}

Clocked ordered_run(const scene::Scene& scene, const Laws& laws, const SchedulerRunOptions& trial) {
  engines::RunOptions options = options_of(trial, scene);
  options.engine = "ordered";
  Clocked clocked;
  engines::run_scene(scene, laws, options, clocked);
  return clocked;
}

}  // namespace

std::size_t events_due(const scene::Scene& scene, const Laws& laws,
                       const SchedulerRunOptions& trial) {
  return ordered_run(scene, laws, trial).recorder.trajectory().events.size();
}

SchedulerRun run_scheduler(const scene::Scene& scene, const Laws& laws,
                           const SchedulerRunOptions& trial, std::size_t due) {
  SchedulerRun run;
  run.n = trial.n;
  run.step_s = std::isnan(trial.step_s) ? scene.step_s : trial.step_s;
  run.due = due;
  run.processes = static_cast<std::size_t>(
      std::count_if(scene.bodies.begin(), scene.bodies.end(),
                    [](const scene::BodySpec& body) { return !body.immovable; }));
  const double begun = cpu_seconds();
  double reference_s = std::numeric_limits<double>::infinity();
  Laws watched = laws;
  stop_when_too_long(trial.most_s, watched);
  // The fastest of several short runs, each with its own reference run.
  for (int k = 0; k < trial.runs && (k == 0 || cpu_seconds() - begun < kShort); ++k) {
    Clocked clocked;
    try {
      engines::run_scene(scene, watched, options_of(trial, scene), clocked);
      count(clocked.recorder.trajectory(), run);
    } catch (const NotImplemented& missing) {
      run.stopped_by = missing.function() + " is not written yet";
      run.not_attempted = true;
    }
    if (!(run.cpu_s <= clocked.cpu_s)) run.cpu_s = clocked.cpu_s;
    if (!run.stopped_by.empty()) break;
    if (laws.scheduling) reference_s = std::min(reference_s, ordered_run(scene, laws, trial).cpu_s);
  }
  // the run contains one of the reference, for the comparison
  if (std::isfinite(reference_s)) run.cpu_s = std::max(kLeast, run.cpu_s - reference_s);
  return run;
}

std::vector<double> scheduler_steps(const scene::Scene& scene) {
  std::vector<double> steps;
  for (int k = 0; k < kSteps; ++k) steps.push_back(kCoarsestWork * scene.step_s * std::pow(0.5, k));
  return steps;
}

}  // namespace tumble::cost
