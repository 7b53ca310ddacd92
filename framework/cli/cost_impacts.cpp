#include "framework/cli/cost_impacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/cli/read_truth.h"
#include "framework/cli/record.h"
#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/dynamics/root_methods.h"
#include "framework/truths/impact_problem.h"
#include "framework/truths/memory_scene.h"

namespace tumble::cli {
namespace {

using truths::ImpactProblem;

constexpr double kStep = 1.0 / 60.0;  // s: the length of the bracket
constexpr int kResolutions = 15;      // tolerances 1e-2 to 1e-16 of a second
constexpr double kMeasured = 5e-3;    // s of CPU at least, for each point
// truths/comparison.h: error of a closed form in the files' own floors
constexpr double kRoundings = 100.0;

struct Problems {
  std::vector<ImpactProblem> all;
  double floor = 0.0, latest = 0.0;  // s
};

Problems problems_of(const Context& context) {
  Problems problems;
  for (const auto& file : find_truths(context.root / "tests" / "truths")) {
    if (!file.filename().string().starts_with("toi_")) continue;
    const truths::Case truth = read_truth(file);
    std::optional<ImpactProblem> problem = truths::impact_problem(truth, kStep);
    if (!problem || !(problem->gap(problem->low) > 0.0) || !(problem->gap(problem->high) < 0.0))
      continue;
    problems.floor = std::max(problems.floor, truth.floor("toi"));
    problems.latest = std::max(problems.latest, problem->toi);
    problems.all.push_back(std::move(*problem));
  }
  if (problems.all.empty())
    throw UserError("tumble cost toi", "tests/truths holds no time of impact",
                    "Restore its files toi_*.json.");
  return problems;
}

/// One root finder at one tolerance, over all problems: the worst error, and the cost of one
/// search.
report::CostPoint point_of(const Problems& problems, const ImpactFinder& find, double tolerance) {
  report::CostPoint point{tolerance_in_words(tolerance), tolerance, 0.0, 0.0, 0.0, ""};
  for (const ImpactProblem& problem : problems.all) {
    const RootResult found =
        find(problem.gap, problem.gap_rate, problem.low, problem.high, tolerance);
    if (found.status == RootStatus::kNoSignChange)
      point.stopped_by = problem.name + ": it sees no impact";
    if (found.status == RootStatus::kNotConverged)
      point.stopped_by = problem.name + ": it does not converge";
    const double error = std::abs(found.time - problem.toi);
    if (!(error <= point.error)) point.error = error;  // keeps NaN
    point.evaluations +=
        static_cast<double>(found.evaluations) / static_cast<double>(problems.all.size());
  }
  const double begun = cpu_seconds();
  int searches = 0;
  while (cpu_seconds() - begun < kMeasured)
    for (const ImpactProblem& problem : problems.all) {
      find(problem.gap, problem.gap_rate, problem.low, problem.high, tolerance);
      ++searches;
    }
  point.cpu_s = (cpu_seconds() - begun) / searches;
  return point;
}

report::CostCurve curve_of(const Problems& problems, const std::string& name,
                           const ImpactFinder& find, const std::vector<double>& tolerances) {
  report::CostCurve curve;
  curve.name = name;
  for (const double tolerance : tolerances) {
    curve.points.push_back(point_of(problems, find, tolerance));
    fmt::print(stderr, "{:<28} {:<20} {}\n", name, curve.points.back().fineness,
               curve.points.back().stopped_by.empty()
                   ? fmt::format("error {} s", few_digits(curve.points.back().error))
                   : curve.points.back().stopped_by);
  }
  const report::CostPoint* best = nullptr;
  for (const report::CostPoint& point : curve.points)
    if (point.stopped_by.empty() && (best == nullptr || point.error < best->error)) best = &point;
  if (best == nullptr)
    curve.reading =
        fmt::format("{} finds no impact: {}.", capitalised(name),
                    curve.points.empty() ? "nothing was run" : curve.points.back().stopped_by);
  else
    curve.reading = fmt::format(
        "{} reaches {} s at {}, with {:.1f} gap evaluations per search, for {}.", capitalised(name),
        few_digits(best->error), best->fineness, best->evaluations, report::price_of(best->cpu_s));
  return curve;
}

/// Ball and plane only: a quadratic.
report::CostCurve curve_of_closed_forms(const Problems& problems) {
  report::CostCurve curve;
  curve.name = "closed form (ball, plane)";
  report::CostPoint point{
      "no tolerance", std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0, 0.0, ""};
  int searches = 0;
  const double begun = cpu_seconds();
  while (cpu_seconds() - begun < kMeasured)
    for (const ImpactProblem& problem : problems.all)
      if (problem.closed_form) {
        point.error = std::max(point.error, std::abs(problem.closed_form() - problem.toi));
        ++searches;
      }
  point.cpu_s = (cpu_seconds() - begun) / std::max(1, searches);
  curve.points.push_back(point);
  curve.reading = fmt::format(
      "{} has an error of {} s and no tolerance to choose; it evaluates no gap, and costs {} "
      "with the case's numbers read each time.",
      capitalised(curve.name), few_digits(point.error), report::price_of(point.cpu_s));
  return curve;
}

std::vector<double> tolerances_of(const CostWords& words) {
  if (!words.tolerances.empty()) return words.tolerances;
  std::vector<double> all;
  for (int k = 0; k < kResolutions; ++k) all.push_back(std::pow(10.0, -2.0 - k));
  return all;
}

}  // namespace

report::CostPage cost_of_impacts(const Context& context, const CostWords& words) {
  // Words that name nothing are refused before the first search.
  for (const std::string& word : words.impacts) root_method_named(word);
  ChosenLaws chosen;
  if (!words.modules.empty()) {
    scene::Scene nothing = truths::empty_scene("times of impact", 1.0, 1e-3);
    nothing.file = context.root / "models" / "none";
    chosen = choose_laws(context, nothing, parse_module_words(words.modules, context.registry));
  }
  const Problems problems = problems_of(context);
  const std::vector<double> tolerances = tolerances_of(words);
  report::CostPage page;
  page.title = "Times of impact";
  page.about = fmt::format(
      "{} cases of tests/truths: balls, rods and boxes on given motions, each searched in the step "
      "of 1/60 s with its impact.",
      problems.all.size());
  page.error_name = "error of the time of impact";
  page.error_unit = "s";
  page.finer = {"tolerance", "s", report::Scale::kLog};
  page.counted = "gaps looked at";
  page.truth = "files computed to 60 digits";
  page.what_error_is = fmt::format(
      "Errors are the largest over these cases, against {}; double precision itself forces {} "
      "s on the latest of them (t = {:.3g} s). Grazing impacts are double roots and left out.",
      page.truth, few_digits(problems.floor), problems.latest);
  page.what_price_is =
      "CPU time is that of one search, the average over the cases. On this machine, in this run: "
      "only ratios matter.";
  page.floor = problems.floor;
  page.scale = kStep;
  page.marks = {1e-6, 1e-9, 1e-12};
  page.record = record_of(context);
  std::vector<std::string> names = words.impacts;
  if (names.empty())
    for (const RootMethod& method : root_methods()) names.push_back(method.word);
  for (const std::string& word : names)
    page.curves.push_back(
        curve_of(problems, root_method_named(word).name, root_method_named(word).find, tolerances));
  if (!words.modules.empty())
    page.curves.push_back(curve_of(problems, "find_impact_time of " + words.modules,
                                   chosen.laws.find_impact_time, tolerances));
  page.curves.push_back(curve_of_closed_forms(problems));
  if (page.curves.back().points.front().error > kRoundings * problems.floor)
    page.readings.push_back(
        "The error of the closed form is more than a few roundings: a file of reference values, or "
        "the formula, is wrong.");
  return page;
}

}  // namespace tumble::cli
