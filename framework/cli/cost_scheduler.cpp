#include "framework/cli/cost_scheduler.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/record.h"
#include "framework/core/error.h"
#include "framework/cost/showcase.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/grading/grades/scheduler_section.h"
#include "framework/report/cost_page.h"
#include "framework/report/tables_json.h"
#include "framework/scene/sized_scenes.h"

namespace tumble::cli {
namespace {

using cost::SchedulerCurve;
using cost::SchedulerReading;
using cost::SchedulerRun;
using cost::SchedulerRunOptions;

constexpr int kSizes[] = {6, 12, 24, 48, 96};
constexpr double kSizedDuration = 1.0;  // s
// expected cost of a size relative to the last one: as many bodies again, and each is tested
// against more
constexpr double kGrowth = 3.0;
constexpr int kRuns = 5;             // of short ones: the fastest counts
constexpr double kMostOfARun = 0.5;  // of the budget
// of the budget, or less where sizes follow: for the runs over steps
constexpr double kOfTheFirst = 0.6;

/// Wall time: a run in a sandbox mostly waits, which is no CPU time of this process.
double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A compared scheduler, or an engine without decisions of a module.
struct Way {
  SchedulerCurve curve;
  std::string modules;  // as for tumble run; empty: an engine
  std::string engine = "tw";
  // its CPU time is another process's: repeating a run improves nothing
  bool is_sandboxed = false;
};

std::string known_words(const CostWords& words) {
  if (!words.methods.empty()) return "--methods";
  if (!words.engines.empty()) return "--engines";
  if (!words.stabilisations.empty()) return "--stabilisations";
  if (!words.impacts.empty()) return "--impacts";
  if (!words.solvers.empty()) return "--solvers";
  return words.tolerances.empty() ? "" : "--tolerances";
}

class Measuring {
 public:
  Measuring(const Context& context, const modules::ModuleKind& kind, const CostWords& words)
      : context_(context),
        kind_(kind),
        words_(words),
        scene_(find_scene(
            context, words.on.empty() ? kind.note<cost::CostShowcase>().scene : words.on, words.n)),
        sized_(words.on.empty() ? kind.note<cost::CostShowcase>().sized_scene : ""),
        until_(now_s() + words.budget()),
        steps_until_(now_s() + kOfTheFirst * words.budget()) {
    steps_ = words.steps_s();
    if (steps_.empty()) steps_ = cost::scheduler_steps(scene_);
    duration_s_ = words.duration_s.value_or(
        words.on.empty() ? kind.note<cost::CostShowcase>().duration_s : scene_.duration_s);
  }

  void run(Way& way) const {
    const bool is_engine = way.modules.empty();
    if (!is_engine) over_steps(way);
    if (!sized_.empty()) over_sizes(way);
  }

  const scene::Scene& scene() const { return scene_; }
  const std::string& sized() const { return sized_; }

 private:
  void over_steps(Way& way) const {
    const ChosenLaws chosen = laws_of(way, scene_);
    SchedulerRunOptions trial = trial_of(way, duration_s_);
    for (const double step : steps_) {
      trial.step_s = step;
      one(scene_, chosen.laws, way, trial, way.curve.by_step);
      if (way.curve.by_step.back().not_attempted || (way.is_sandboxed && now_s() > steps_until_))
        return;
    }
  }

  void over_sizes(Way& way) const {
    const ChosenLaws chosen = laws_of(way, find_scene(context_, sized_, kSizes[0]));
    double took = 0.0;
    for (const int n : kSizes) {
      if (now_s() + kGrowth * took > until_) return;
      SchedulerRunOptions trial = trial_of(way, kSizedDuration);
      trial.n = n;
      const double begun = now_s();
      one(find_scene(context_, sized_, n), chosen.laws, way, trial, way.curve.by_size);
      took = now_s() - begun;
      if (way.curve.by_size.back().not_attempted) return;
    }
  }

  SchedulerRunOptions trial_of(const Way& way, double duration_s) const {
    SchedulerRunOptions trial;
    trial.engine = way.engine;
    trial.timewarp = engines::fast_timewarp();
    trial.duration_s = duration_s;
    trial.runs = way.is_sandboxed ? 1 : kRuns;
    trial.most_s = kMostOfARun * words_.budget();
    return trial;
  }

  /// Other modules come from the reference where there is one.
  ChosenLaws laws_of(const Way& way, const scene::Scene& scene) const {
    std::string words = way.modules;
    for (const std::string& id : scene.needs)
      if (id != kind_.id &&
          std::filesystem::exists(context_.build / "modules" / (id + "_reference.so")))
        words += (words.empty() ? "" : ",") + id + "=reference";
    ChosenLaws chosen = choose_laws(context_, scene, parse_module_words(words, context_.registry));
    for (const std::string& notice : chosen.notices) fmt::print(stderr, "{}\n", notice);
    if (way.modules.empty()) chosen.laws.scheduling = {};
    return chosen;
  }

  void one(const scene::Scene& scene, const Laws& laws, const Way& way,
           const SchedulerRunOptions& trial, std::vector<SchedulerRun>& runs) const {
    runs.push_back(cost::run_scheduler(scene, laws, trial, cost::events_due(scene, laws, trial)));
    const SchedulerRun& run = runs.back();
    const std::string found =
        run.is_right() ? fmt::format("{:.2f} integrations per event, {}",
                                     run.per_event(run.integrations), report::price_of(run.cpu_s))
                       : fmt::format("{} of {} events", run.committed, run.due);
    fmt::print(stderr, "{:<28} {:>3} processes, step {:<10} {:<44} at most {:.0f} s left\n",
               way.curve.name, run.processes, fmt::format("{:.3g} s", run.step_s), found,
               std::max(0.0, until_ - now_s()));
  }

  const Context& context_;
  const modules::ModuleKind& kind_;
  const CostWords& words_;
  scene::Scene scene_;
  std::string sized_;
  double until_, steps_until_, duration_s_ = kUnset;
  std::vector<double> steps_;
};

/// The student's scheduler, engines without a module, and last the reference.
std::vector<Way> methods_of(const Context& context, const modules::ModuleKind& kind,
                            const CostWords& words) {
  const std::string word = words.modules.empty() ? "student" : words.modules;
  const bool has_reference =
      std::filesystem::exists(context.build / "modules" / (kind.id + "_reference.so"));
  const char* subject = word == "reference" ? "reference scheduler" : "your scheduler";
  std::vector<Way> ways{{{subject, false, {}, {}},
                         kind.id + "=" + word,
                         "tw",
                         word != "student" && word != "reference"}};
  if (has_reference && word != "reference")
    ways.push_back({{"reference", true, {}, {}}, kind.id + "=reference"});
  for (const auto& [engine, meaning] : engines::engine_words())
    if (engine != "rd" && (engine != "tw" || engines::fast_timewarp()))
      ways.push_back(
          {{engine == "tw" ? "tw, the fast scheduler" : engine + ", " + meaning, false, {}, {}},
           "",
           engine});
  return ways;
}

report::Plot plot_of_prices(const std::vector<Way>& ways) {
  report::Plot plot{"CPU time against the number of processes",
                    {"processes", "-", report::Scale::kLog},
                    {"CPU time for each committed event", "s", report::Scale::kLog},
                    {},
                    {},
                    "The cost of the same trace by each engine. The engine that calls a module is "
                    "written to be understood: it tests every body against every other. In the "
                    "sandbox each call costs extra, mostly waiting."};
  for (const Way& way : ways) {
    report::Curve curve{way.curve.name, {}, {}, true};
    for (const SchedulerRun& run : way.curve.by_size) {
      if (!run.is_right() || run.committed == 0) continue;
      curve.x.push_back(static_cast<double>(run.processes));
      curve.y.push_back(run.cpu_s / static_cast<double>(run.committed));
    }
    if (curve.x.empty()) curve.name.clear();
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.2f}", value) : "-";
}

// Counts of every run, each as a number of the whole run.
nlohmann::ordered_json json_of(const std::vector<Way>& ways) {
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  for (const Way& way : ways)
    for (const auto* ladder : {&way.curve.by_step, &way.curve.by_size})
      for (const SchedulerRun& run : *ladder)
        runs.push_back({{"name", way.curve.name},
                        {"processes", run.processes},
                        {"step_s", run.step_s},
                        {"committed", run.committed},
                        {"due", run.due},
                        {"integrations", run.integrations},
                        {"undone", run.undone},
                        {"rollbacks", run.rollbacks},
                        {"states_kept", run.states_kept},
                        {"cpu_s", run.cpu_s}});
  return runs;
}

void print(const std::vector<Way>& ways) {
  fmt::print("{:<52} {:>9} {:>9} {:>12} {:>12} {:>10} {:>10} {:>7} {:>10}\n",
             "for each committed event:", "processes", "step [s]", "committed", "integrations",
             "undone", "rollbacks", "states", "CPU");
  for (const Way& way : ways)
    for (const auto* ladder : {&way.curve.by_step, &way.curve.by_size})
      for (const SchedulerRun& run : *ladder)
        fmt::print("{:<52} {:>9} {:>9.3g} {:>12} {:>12} {:>10} {:>10} {:>7} {:>10}\n",
                   way.curve.name, run.processes, run.step_s,
                   fmt::format("{}/{}", run.committed, run.due),
                   number(run.per_event(run.integrations)), number(run.per_event(run.undone)),
                   way.modules.empty() ? "-" : number(run.per_event(run.rollbacks)),
                   way.modules.empty() ? "-" : std::to_string(run.states_kept),
                   report::price_of(run.cpu_s /
                                    static_cast<double>(std::max<std::size_t>(1, run.committed))));
}

}  // namespace

void cost_of_scheduler(Context& context, const modules::ModuleKind& kind, const CostWords& words) {
  if (const std::string flag = known_words(words); !flag.empty())
    throw UserError(flag,
                    "a scheduler decides in which order a scene goes on, not by which method, so "
                    "this changes nothing in tumble cost " +
                        kind.id,
                    "Leave it out. What can be chosen: --modules, --on SCENE, --steps, "
                    "--duration-s, --n, --budget-s.");
  if (words.modules == "library") refuse_library(kind, "scheduler");
  const Measuring measuring(context, kind, words);
  std::vector<Way> ways = methods_of(context, kind, words);
  for (Way& way : ways) measuring.run(way);

  // The sentences compare the scheduler with the reference.
  std::vector<SchedulerCurve> curves{ways[0].curve};
  if (ways.size() > 1 && ways[1].curve.is_reference) curves.push_back(ways[1].curve);
  const std::vector<SchedulerReading> readings =
      cost::read_scheduler(curves[0], curves.size() > 1 ? &curves[1] : nullptr);
  const std::string scenes =
      measuring.scene().title +
      (measuring.sized().empty()
           ? ""
           : "; and at growing size: " + scene::sized_scene_named(measuring.sized())->title);

  // The same on stdout and on the page.
  const std::string subject = fmt::format(
      "{} ({}) on: {}", kind.id, words.modules.empty() ? "student" : words.modules, scenes);
  if (!words.json) {
    fmt::print("{}\n", subject);
    print(ways);
  }
  std::vector<std::string> sentences;
  report::Page page("What accuracy costs", subject);
  for (const SchedulerReading& reading : readings) {
    const grading::CostLine line = grading::line_of(reading);
    sentences.push_back(line.reading);
    if (!words.json) fmt::print("  {}\n", line.reading);
    page.paragraph(line.reading, line.is_wasteful    ? report::Look::kWarning
                                 : line.is_right     ? report::Look::kGood
                                 : line.is_attempted ? report::Look::kBad
                                                     : report::Look::kMuted);
    if (line.more.empty()) continue;
    if (!words.json) fmt::print("{}\n", line.more);
    page.fold("More about it", line.more);
  }
  for (const report::Plot& plot : grading::scheduler_plots(curves)) page.plot(plot);
  if (!measuring.sized().empty()) page.plot(plot_of_prices(ways));
  page.table(grading::scheduler_table(curves));
  page.heading("How it was measured");
  page.paragraph(measuring.scene().about);
  page.paragraph(grading::what_a_scheduler_pays());
  page.paragraph(
      "CPU time is that of the engine without the ordered reference that each run is compared "
      "with, the best of up to five runs. On this machine, in this run: only ratios matter.");
  page.record(record_of(context, measuring.scene()));
  const std::filesystem::path file = std::filesystem::path(words.out) / words.name() / "index.html";
  page.write(file);
  if (words.json)
    print_json(context, {{"title", subject},
                         {"readings", sentences},
                         {"runs", json_of(ways)},
                         {"is_sandboxed", ways[0].is_sandboxed},
                         {"page", file.string()}});
  if (ways[0].is_sandboxed && !words.json)
    fmt::print(
        "This module runs in the sandbox, where each decision crosses to another process and back: "
        "compare its counts, not its CPU time.\n");
  if (!words.json) fmt::print("{}\n", file.string());
  if (std::any_of(readings.begin(), readings.end(), [](const SchedulerReading& reading) {
        return reading.kind == SchedulerReading::Kind::kNotWritten;
      }))
    context.exit = ExitCode::kNotAttempted;
}

}  // namespace tumble::cli
