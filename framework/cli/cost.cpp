// tumble cost SCENE: error against cost in a scene, by every method and engine, with plots and
// sentences.
// tumble cost a2: the same for a student's module, against the reference. tumble cost toi: for
// times of impact. tumble cost all: for every scene.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/cost_all.h"
#include "framework/cli/cost_impacts.h"
#include "framework/cli/cost_measure.h"
#include "framework/cli/cost_sampling.h"
#include "framework/cli/cost_scheduler.h"
#include "framework/cli/json_output.h"
#include "framework/cli/kept_at_stop.h"
#include "framework/core/files.h"
#include "framework/core/text.h"
#include "framework/report/tables_json.h"
#include "framework/sampling/sampler.h"

namespace tumble::cli {
namespace {

void print(const report::CostPage& page) {
  std::size_t width = 30;
  for (const report::CostCurve& curve : page.curves) width = std::max(width, curve.name.size());
  fmt::print("{:<{}} {:>6}  {:<32}", "", width, "order", "least error");
  for (const double mark : page.marks) fmt::print(" {:>14}", report::mark_in_words(page, mark));
  fmt::print("\n");
  for (const report::CostCurve& curve : page.curves) {
    const report::CostPoint* least = nullptr;
    for (const report::CostPoint& point : curve.points)
      if (point.stopped_by.empty() && std::isfinite(point.error) &&
          (least == nullptr || point.error < least->error))
        least = &point;
    fmt::print("{:<{}} {:>6}  {:<32}", curve.name, width,
               std::isfinite(curve.order) ? fmt::format("{:.2f}", curve.order) : "-",
               least == nullptr ? "does not reach the end"
                                : fmt::format("{}{} at {}", few_digits(least->error),
                                              page.error_unit.empty() ? "" : " " + page.error_unit,
                                              least->fineness));
    for (const double mark : page.marks) {
      const report::CostPoint* point = report::cheapest(curve, mark);
      fmt::print(" {:>14}", point == nullptr ? "-" : report::price_of(point->cpu_s));
    }
    fmt::print("\n");
  }
}

// @param head  what is measured, and against what: on stdout only
void print_and_write(const Context& context, const report::CostPage& page, const CostWords& words,
                     const std::string& head) {
  const std::filesystem::path file = std::filesystem::path(words.out) / words.name() / "index.html";
  report::write_cost_page(page, file);
  if (words.json) {
    nlohmann::ordered_json parts = report::json_of(page);
    parts["page"] = file.string();
    return print_json(context, parts);
  }
  fmt::print("{}\n  {}\n", page.title, head);
  print(page);
  for (const report::CostCurve& curve : page.curves) fmt::print("  {}\n", curve.reading);
  for (const std::string& reading : page.readings) fmt::print("{}\n", reading);
  for (const std::string& what : page.not_run) fmt::print("Not run: {}.\n", what);
  fmt::print("{}\n", file.string());
}

void tell_impacts(const Context& context, const CostWords& words) {
  report::CostPage page = cost_of_impacts(context, words);
  for (const std::string& verdict : verdicts(page)) page.readings.push_back(verdict);
  print_and_write(context, page, words, page.about);
}

void run_cost(Context& context, const CostWords& words) {
  const std::filesystem::path out = words.out;
  expect_writable((words.scene == kAllWord ? out : out / words.name()) / "index.html");
  KeptAtStop stop(words.scene == kAllWord ? "scenes" : "methods");
  if (words.scene == kImpactWord) return tell_impacts(context, words);
  if (words.scene == kAllWord) return cost_of_all(context, words, stop);
  for (const modules::ModuleKind* kind : context.registry.all()) {
    if (kind->id != words.scene) continue;
    if (kind->is_scheduler) return cost_of_scheduler(context, *kind, words);
    if (kind->note<sampling::Sampler>().functions) return cost_of_sampling(context, *kind, words);
  }
  const auto keep = [&](const MeasuredCost& so_far, std::size_t done, std::size_t all) {
    const std::filesystem::path page = out / words.name() / "index.html";
    stop.keep(done, all, page.string(), [&] { report::write_cost_page(so_far.page, page); });
  };
  const MeasuredCost measured = measure_cost(context, words, keep);
  print_and_write(context, measured.page, words, measured.against);
  if (measured.not_attempted) context.exit = ExitCode::kNotAttempted;
}

}  // namespace

void add_cost(CLI::App& app, Context& context) {
  auto words = std::make_shared<CostWords>();
  Verb verb(app, "cost",
            "Error against CPU time by every method, step and engine, with plots and sentences");
  verb.option(
          "scene", words->scene,
          "A scene file, the bare name of one, a scene with a size, an assignment (such as a2): "
          "the student's module against the reference; toi: root finders on times of impact; "
          "or all: every scene, and one table")
      .required()
      .type_name("SCENE");
  verb.option("--methods", words->methods,
              "Methods of integration, with commas: euler, symplectic, midpoint, verlet, rk4, "
              "dopri5, fehlberg78, bulirsch-stoer, rosenbrock4 and gauss6 (implicit); none")
      .separated_by(',');
  verb.option("--engines", words->engines,
              "Beside rd with each method: auto (rd, in closed form where nothing but gravity "
              "acts), ca, tw, ordered; none")
      .separated_by(',');
  verb.option("--stabilisations", words->stabilisations,
              "Stabilisation of rods and joints, each with RK4: none, baumgarte, projection")
      .separated_by(',');
  verb.option("--coordinates", words->coordinates,
              "In which rods and joints are integrated: maximal, reduced; default: both, where "
              "bodies are linked and none collides")
      .separated_by(',');
  verb.option("--impacts", words->impacts,
              "Which root finder looks for impacts, over its tolerance: bisection, newton, toms748")
      .separated_by(',');
  verb.option("--solvers", words->solvers,
              "Iterative solvers in place of direct ones, over their tolerance: gradients (rods "
              "and joints), sweeps, newton (persistent contacts)")
      .separated_by(',');
  verb.option("--steps", words->steps,
              "Steps [s], such as 1/30,1/60,0.001, instead of halvings until the budget is used")
      .separated_by(',')
      .type_name("STEPS");
  verb.option("--tolerances", words->tolerances,
              "Tolerances of methods that control their error, instead of 0.1, 0.01, ... (with "
              "rods or joints from 1e-4 on)")
      .separated_by(',')
      .positive();
  verb.option("--modules", words->modules,
              "Whose laws, as for tumble run; of an assignment: whose module is measured (default "
              "student)")
      .type_name("WORDS");
  verb.option("--on", words->on, "Of an assignment: the scene that it is measured on")
      .type_name("SCENE");
  verb.option("--duration-s", words->duration_s, "Simulated time [s] instead of the scene's")
      .positive();
  verb.option("--budget-s", words->budget_s,
              "CPU time of all methods together [s], default 30, with all: 4 per scene; the "
              "reference solution takes at most 18 s more")
      .positive();
  verb.option("--n", words->n, "Size of a scene whose size is a parameter").positive();
  verb.option("--out", words->out, "Folder in which the page SCENE/index.html is made")
      .shows_default();
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Example: tumble cost double_pendulum\n         tumble cost a2 --modules "
      "mine/a2_integration.cpp\nTimes are CPU times in this run and are meant to be compared with "
      "each other only.");
  verb.runs([&context, words] { run_cost(context, *words); });
}

}  // namespace tumble::cli
