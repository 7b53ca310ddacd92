#include "framework/grading/grades/scheduler_section.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/cost/showcase.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/course/laws_around.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/scene/load_scene.h"
#include "framework/scene/sized_scenes.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using cost::SchedulerCurve;
using cost::SchedulerReading;
using cost::SchedulerRun;
using cost::SchedulerRunOptions;
using modules::AnyModule;
using modules::ModuleKind;

// Scenes are small, because each decision of a submission is a call into the sandbox.
constexpr int kSizes[] = {6, 12, 24};
constexpr double kSizedDuration = 0.5;  // s

double percent(double part) { return 100.0 * part; }

/// Adds a curve; the reference is last, in the submission's colours with hollow marks.
void place(const SchedulerCurve& whose, report::Curve curve, report::Plot& plot) {
  // keeps its place, so that colours have the same meaning in both
  if (curve.x.empty()) curve.name.clear();
  if (whose.is_reference && plot.curves.size() < report::kReferenceStyles)
    plot.curves.resize(report::kReferenceStyles);
  plot.curves.push_back(report::sorted_by_x(std::move(curve)));
}

report::Plot plot_of_errors(const std::vector<SchedulerCurve>& curves) {
  report::Plot plot{"Error against work",
                    {"integrations for each committed event", "-", report::Scale::kLog},
                    {"events of the reference not committed", "%"},
                    {},
                    {},
                    "At 0 % a scheduler is right; farther left is cheaper. Each mark is a run with "
                    "another step, or another number of processes."};
  for (const SchedulerCurve& whose : curves)
    for (const auto& [sequence, what] :
         {std::pair{&whose.by_step, "by step"}, std::pair{&whose.by_size, "by size"}}) {
      report::Curve curve{fmt::format("{}, {}", whose.name, what), {}, {}, true};
      for (const SchedulerRun& run : *sequence) {
        if (run.committed == 0 || run.integrations == 0) continue;
        curve.x.push_back(run.per_event(run.integrations));
        curve.y.push_back(percent(run.error()));
      }
      place(whose, std::move(curve), plot);
    }
  return plot;
}

/// Work per event over one sequence of runs, only of right runs.
report::Plot plot_of_work(const std::vector<SchedulerCurve>& curves,
                          std::vector<SchedulerRun> SchedulerCurve::*sequence, report::Axis across,
                          const std::string& title, double (*x)(const SchedulerRun&),
                          const std::string& caption) {
  report::Plot plot{
      title,  std::move(across), {"for each committed event", "-", report::Scale::kLog}, {}, {},
      caption};
  for (const SchedulerCurve& whose : curves) {
    using Count = std::uint64_t SchedulerRun::*;
    for (const auto& [count, what] :
         {std::pair<Count, const char*>{&SchedulerRun::integrations, "integrations"},
          {&SchedulerRun::undone, "undone"},
          {&SchedulerRun::rollbacks, "rollbacks"},
          {&SchedulerRun::checks, "checks of pairs"}}) {
      report::Curve curve{fmt::format("{}: {}", whose.name, what), {}, {}, true};
      for (const SchedulerRun& run : whose.*sequence) {
        if (!run.is_right() || run.integrations == 0) continue;
        curve.x.push_back(x(run));
        curve.y.push_back(run.per_event(run.*count));
      }
      place(whose, std::move(curve), plot);
    }
  }
  return plot;
}

bool has(const std::vector<SchedulerCurve>& curves,
         std::vector<SchedulerRun> SchedulerCurve::*sequence) {
  return std::any_of(curves.begin(), curves.end(), [sequence](const SchedulerCurve& curve) {
    return (curve.*sequence).size() > 1;
  });
}

/// Runs one sequence; a hang or crash in the sandbox ends it.
class RunSequence {
 public:
  RunSequence(const Course& course, const ModuleKind& kind)
      : course_(course), kind_(kind), reference_(reference_of(course, kind)) {}
  const AnyModule& reference() const { return reference_; }

  /// @param between  called before each run
  void run(const AnyModule& module, const std::string& source, const std::function<void()>& between,
           SchedulerCurve& curve) const {
    const fs::path file = course_.root / "assignments" / kind_.folder / "scenes" /
                          (kind_.note<cost::CostShowcase>().scene + ".json");
    const scene::Scene scene = scene::load_scene(file);
    for (const double step : cost::scheduler_steps(scene)) {
      SchedulerRunOptions trial;
      trial.step_s = step;
      trial.duration_s = kind_.note<cost::CostShowcase>().duration_s;
      between();
      if (!one(scene, module, source, trial, curve.by_step)) return;
    }
    if (kind_.note<cost::CostShowcase>().sized_scene.empty()) return;
    for (const int n : kSizes) {
      SchedulerRunOptions trial;
      trial.n = n;
      trial.duration_s = kSizedDuration;
      between();
      if (!one(scene::make_sized_scene(kind_.note<cost::CostShowcase>().sized_scene, n), module,
               source, trial, curve.by_size))
        return;
    }
  }

 private:
  bool one(const scene::Scene& scene, const AnyModule& module, const std::string& source,
           const SchedulerRunOptions& trial, std::vector<SchedulerRun>& runs) const {
    const std::size_t due =
        cost::events_due(scene, laws_around(course_, kind_, nullptr, "", scene), trial);
    runs.push_back(
        cost::run_scheduler(scene, laws_around(course_, kind_, module, source, scene), trial, due));
    return !call_log().noted;  // a hang, a crash or a stub would repeat
  }

  const Course& course_;
  const ModuleKind& kind_;
  AnyModule reference_;
};

}  // namespace

CostLine line_of(const SchedulerReading& reading) {
  CostLine line = line_that_says(reading.text);
  line.is_wasteful = reading.kind == SchedulerReading::Kind::kWasteful;
  line.is_right = line.is_wasteful || reading.kind == SchedulerReading::Kind::kRight;
  line.is_attempted = reading.kind != SchedulerReading::Kind::kNotWritten;
  return line;
}

std::vector<report::Plot> scheduler_plots(const std::vector<SchedulerCurve>& curves) {
  std::vector<report::Plot> plots{plot_of_errors(curves)};
  if (has(curves, &SchedulerCurve::by_step))
    plots.push_back(plot_of_work(
        curves, &SchedulerCurve::by_step, {"step of a process", "s", report::Scale::kLog},
        "Work against the step", [](const SchedulerRun& run) { return run.step_s; },
        "Large steps are often rolled back, small steps are many. Wrong runs are not drawn."));
  if (has(curves, &SchedulerCurve::by_size))
    plots.push_back(plot_of_work(
        curves, &SchedulerCurve::by_size, {"processes", "-", report::Scale::kLog},
        "Work against the number of processes",
        [](const SchedulerRun& run) { return static_cast<double>(run.processes); },
        "Where a straggler rolls back only the processes that it concerns, the cost of an event "
        "does not depend on the number of processes."));
  return plots;
}

report::Table scheduler_table(const std::vector<SchedulerCurve>& curves) {
  report::Table table;
  table.caption = "Every run, in counts that are the same on any machine.";
  table.columns = {{""},
                   {"processes", true},
                   {"step [s]", true},
                   {"committed", true},
                   {"integrations", true},
                   {"undone", true},
                   {"rollbacks", true},
                   {"anti-messages", true},
                   {"checks", true},
                   {"states", true}};
  for (const SchedulerCurve& curve : curves)
    for (const auto* sequence : {&curve.by_step, &curve.by_size})
      for (const SchedulerRun& run : *sequence) {
        std::vector<report::Cell> cells{
            {curve.name},
            {std::to_string(run.processes)},
            {step_in_words(run.step_s)},
            {fmt::format("{} of {}", run.committed, run.due), "",
             run.is_right() ? report::Look::kGood : report::Look::kBad}};
        for (const std::uint64_t count : {run.integrations, run.undone, run.rollbacks,
                                          run.anti_messages, run.checks, run.states_kept})
          cells.push_back({std::to_string(count)});
        table.rows.push_back(std::move(cells));
      }
  return table;
}

std::string what_a_scheduler_pays() {
  return "Errors are relative to the sequential reference, which executes the events in order: the "
         "fraction of its events that a scheduler does not commit, in order and to the last bit, "
         "before it differs or makes no progress. "
         "Costs are counts per committed event: integrations (steps of a process), undone "
         "integrations, rollbacks of bodies, checks of pairs.";
}

CostSection measure_scheduler(const Course& course, const ModuleKind& kind,
                              const fs::path& submission, const CostSectionOptions& options) {
  if (!kind.note<cost::CostShowcase>().is_graded) return {};
  const RunSequence sequence(course, kind);
  if (!sequence.reference()) return {};  // nor laws for the impulses
  WorkerOptions worker;
  worker.id = kind.id;
  worker.module = submission;
  worker.programs = course.build / "bin";
  worker.call_own_s = options.call_wall_s;
  worker.session_own_s = options.session_wall_s;
  call_log() = CallLog{};
  WorkerConnection connection(worker);
  std::vector<SchedulerCurve> curves{{"your scheduler", false, {}, {}}};
  // each run has its own worker and time limit
  sequence.run(
      kind.make_proxy(connection), "submission", [&] { connection.reset(); }, curves[0]);
  call_log() = CallLog{};
  curves.push_back({"reference", true, {}, {}});
  sequence.run(
      sequence.reference(), "reference", [] {}, curves[1]);
  CostSection section;
  section.scene = scene::load_scene(course.root / "assignments" / kind.folder / "scenes" /
                                    (kind.note<cost::CostShowcase>().scene + ".json"))
                      .title;
  section.truth = what_a_scheduler_pays();
  for (const SchedulerReading& reading : cost::read_scheduler(curves[0], &curves[1]))
    section.lines.push_back(line_of(reading));
  section.plots = scheduler_plots(curves);
  section.tables.push_back(scheduler_table(curves));
  return section;
}

}  // namespace tumble::grading
