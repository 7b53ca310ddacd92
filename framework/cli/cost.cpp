// tumble cost SCENE: what accuracy costs in a scene, by every method and engine, drawn and read.
// tumble cost a2: the same for a student's module, against the reference.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/cli/cost_impacts.h"
#include "framework/cli/cost_ways.h"
#include "framework/cli/scene_run.h"
#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/engines/cost/cost.h"
#include "framework/engines/cost/reading.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/report/cost_page.h"

namespace tumble::cli {
namespace {

using engines::CostRung;
using engines::CostTruth;
using engines::CostWay;

constexpr double kLeastRung = 2.0;   // s of CPU that any run may take
constexpr double kLongest = 2.0;     // shares of the budget, likewise

struct Ladder {
  CostWay way;
  std::vector<CostRung> rungs;
};

std::string fineness_of(const CostRung& rung) {
  if (std::isfinite(rung.tolerance)) return fmt::format("tolerance\u00a0{:.0e}", rung.tolerance);
  if (!std::isfinite(rung.step_s)) return "no step";
  return 1.0 / rung.step_s >= 10 ? fmt::format("1/{:.0f}\u00a0s", 1.0 / rung.step_s) : fmt::format("{:.3g} s", rung.step_s);
}

bool is_smooth(const scene::Scene& scene) {
  const auto collide = std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const scene::BodySpec& body) { return body.collides; });
  return collide < 2 && scene.rods.empty() && scene.joints.empty() && scene.motors.empty();
}

/// Runs whose error is no answer cost nothing worth comparing.
double middle_price(const std::vector<Ladder>& ladders, const CostTruth& truth) {
  std::vector<double> prices;
  for (const Ladder& ladder : ladders)
    for (const CostRung& rung : ladder.rungs)
      if (rung.stopped_by.empty() && rung.error_m < truth.scale_m) prices.push_back(rung.cpu_s);
  if (prices.empty()) return 1.0;
  std::sort(prices.begin(), prices.end());
  return prices[prices.size() / 2];
}

report::CostCurve curve_of(const Ladder& ladder, const CostTruth& truth, double price, bool smooth) {
  report::CostCurve curve;
  curve.name = ladder.way.name;
  curve.reading = engines::read_ladder(ladder.way, ladder.rungs, truth, smooth);
  const auto fit = engines::order_of(ladder.way, ladder.rungs, truth);
  if (fit && !ladder.way.controlled) curve.order = fit->order;
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < ladder.rungs.size(); ++k) {
    const CostRung& rung = ladder.rungs[k];
    curve.points.push_back({fineness_of(rung), ladder.way.controlled ? kUnset : rung.step_s, rung.error_m, rung.cpu_s, static_cast<double>(rung.evaluations), rung.stopped_by});
    const double off = std::abs(std::log(rung.cpu_s / price));
    if (!rung.stopped_by.empty() || !(off < closest)) continue;
    closest = off;
    curve.example = k;
    curve.times = rung.times;
    curve.energy_errors = rung.energy_errors;
    curve.stage_seconds = rung.stage_seconds;
  }
  return curve;
}

/// Which method pays at which accuracy.
std::vector<std::string> verdicts(const report::CostPage& page) {
  std::vector<std::string> words;
  for (const double mark : page.marks) {
    const report::CostCurve* best = nullptr;
    for (const report::CostCurve& curve : page.curves) {
      const report::CostPoint* point = report::cheapest(curve, mark);
      if (point != nullptr && (best == nullptr || point->cpu_s < report::cheapest(*best, mark)->cpu_s)) best = &curve;
    }
    if (best == nullptr) words.push_back(fmt::format("{}: nothing here gets there.", report::mark_in_words(page, mark)));
    else words.push_back(fmt::format("{} costs {} at least: {}, {}.", report::mark_in_words(page, mark), report::price_of(report::cheapest(*best, mark)->cpu_s), best->name, report::cheapest(*best, mark)->fineness));
  }
  return words;
}

void print(const report::CostPage& page) {
  fmt::print("{:<30} {:>6}  {:<32}", "", "order", "least error");
  for (const double mark : page.marks) fmt::print(" {:>14}", report::mark_in_words(page, mark));
  fmt::print("\n");
  for (const report::CostCurve& curve : page.curves) {
    const report::CostPoint* least = nullptr;
    for (const report::CostPoint& point : curve.points)
      if (point.stopped_by.empty() && std::isfinite(point.error) && (least == nullptr || point.error < least->error)) least = &point;
    fmt::print("{:<30} {:>6}  {:<32}", curve.name, std::isfinite(curve.order) ? fmt::format("{:.2f}", curve.order) : "-",
               least == nullptr ? "does not get through" : fmt::format("{:.1e}{} at {}", least->error, page.error_unit.empty() ? "" : " " + page.error_unit, least->fineness));
    for (const double mark : page.marks) {
      const report::CostPoint* point = report::cheapest(curve, mark);
      fmt::print(" {:>14}", point == nullptr ? "-" : report::price_of(point->cpu_s));
    }
    fmt::print("\n");
  }
}

std::string what_error_is(const CostTruth& truth) {
  if (truth.by_numbers)
    return fmt::format("There is no truth to compare places with ({}). So each run is judged as tumble run judges it, and its error is the worst of the scene's numbers over what that number is allowed: up to 1 is right. "
                       "Where nothing at all is allowed and something is there, a run has no such error and is not drawn.", truth.why_by_numbers);
  return fmt::format("Errors are against {}: {:.1e} m. The error of a body is how far its centre of mass is out of place, plus the angle by which it is turned wrongly times its radius of gyration; the "
                     "largest over all movable bodies and samples counts. An error of {:.1e} m, which is as far as bodies move, is no answer, and is not drawn.", truth.what, truth.floor_m, truth.scale_m);
}

std::vector<Ladder> run_all(const scene::Scene& scene, std::vector<CostWay> ways, const CostTruth& truth, const CostWords& words, const engines::CostOptions& options) {
  std::vector<Ladder> ladders;
  const double begun = cpu_seconds(), until = begun + words.budget_s;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    if (k > 0 && cpu_seconds() > until) {
      fmt::print(stderr, "{:>2}/{} {:<28} not run: the budget of {:g} s is used up\n", k + 1, ways.size(), ways[k].name, words.budget_s);
      continue;
    }
    const double left = std::max(0.0, until - cpu_seconds()), share = left / static_cast<double>(ways.size() - k);
    Ladder ladder{std::move(ways[k]), {}};
    engines::CostOptions own = options;
    own.most_of_rung_s = std::max(kLeastRung, std::min(left, kLongest * share));
    ladder.rungs = engines::run_ladder(scene, ladder.way, truth, share, own, words.steps_s(), words.tolerances, [&](const CostRung& rung) {
      const std::string found = rung.stopped_by.empty() ? fmt::format("error {:.1e}{}, {}", rung.error_m, truth.by_numbers ? " of allowed" : " m", report::price_of(rung.cpu_s)) : "stopped";
      fmt::print(stderr, "{:>2}/{} {:<28} {:<16} {:<28} at most {:.0f} s left\n", k + 1, ways.size(), ladder.way.name, fineness_of(rung), found, std::max(0.0, until - cpu_seconds()));
    });
    ladders.push_back(std::move(ladder));
  }
  return ladders;
}

void print_and_write(const report::CostPage& page, const CostWords& words) {
  print(page);
  for (const report::CostCurve& curve : page.curves) fmt::print("  {}\n", curve.reading);
  for (const std::string& reading : page.readings) fmt::print("{}\n", reading);
  const std::filesystem::path file = std::filesystem::path(words.out) / words.name() / "index.html";
  report::write_cost_page(page, file);
  fmt::print("{}\n", file.string());
}

void tell_impacts(const Context& context, const CostWords& words) {
  report::CostPage page = cost_of_impacts(context, words);
  for (const std::string& verdict : verdicts(page)) page.readings.push_back(verdict);
  fmt::print("{}\n  {}\n", page.title, page.about);
  print_and_write(page, words);
}

void tell(Context& context, const std::vector<Ladder>& ladders, const CostTruth& truth, const CostWords& words, const CostSubject& subject) {
  report::CostPage page;
  page.title = subject.title;
  page.about = subject.scene.about;
  page.truth = truth.what;
  page.what_error_is = what_error_is(truth);
  if (truth.by_numbers) {
    page.error_name = "worst number over what is allowed";
    page.error_unit.clear();
    page.marks = {1.0, 0.1};
  }
  page.floor = truth.floor_m;
  page.scale = truth.scale_m;
  page.record = context.command_line;
  const double price = middle_price(ladders, truth);
  for (const Ladder& ladder : ladders) page.curves.push_back(curve_of(ladder, truth, price, is_smooth(subject.scene)));
  page.readings = verdicts(page);
  if (truth.by_numbers) page.readings.push_back("Judged by the scene's own numbers, for there is no truth to compare places with: " + truth.why_by_numbers + ".");
  else if (truth.duration_s < (1.0 - 1e-9) * truth.asked_s)
    page.readings.push_back(fmt::format("Looked at are the first {:.3g} s of {:.3g} s: {}.", truth.duration_s, truth.asked_s, truth.shortened_by));
  if (!subject.note.empty()) page.readings.push_back(subject.note);
  if (truth.by_numbers) fmt::print("{}\n  judged by its numbers, over {:.3g} s: the worst of them over what it is allowed [-]\n", subject.title, truth.duration_s);
  else fmt::print("{}\n  error: against {}: {:.1e} m, over {:.3g} s\n", subject.title, truth.what, truth.floor_m, truth.duration_s);
  print_and_write(page, words);
  const auto unwritten = [](const Ladder& ladder) { return !ladder.rungs.empty() && ladder.rungs.back().not_attempted; };
  if (std::any_of(ladders.begin(), ladders.end(), unwritten)) context.exit = ExitCode::kNotAttempted;
}

void run_cost(Context& context, const CostWords& words) {
  if (words.scene == kImpactWord) return tell_impacts(context, words);
  engines::CostOptions options;
  options.timewarp = engines::fast_timewarp();
  const CostSubject subject = find_subject(context, words);
  options.duration_s = words.duration_s ? words.duration_s : subject.duration_s;
  options.told = [](const std::string& what) { fmt::print(stderr, "tumble: {}\n", what); };
  std::string why;
  const std::optional<CostTruth> found = engines::try_truth(subject.scene, subject.truth_laws, options, why);
  if (!found && subject.scene.checks.empty()) throw UserError(subject.scene.name, "there is no truth to compare with (" + why + "), and the scene has no numbers to be judged by", "Give it \"checks\", or a shorter --duration-s.");
  const CostTruth truth = found ? *found : engines::by_numbers(subject.scene, options, why);
  if (!found) fmt::print(stderr, "tumble: no truth ({}): runs are judged by the scene's numbers\n", why);
  const std::vector<Ladder> ladders = run_all(subject.scene, subject.ways, truth, words, options);
  tell(context, ladders, truth, words, subject);
}

}  // namespace

void add_cost(CLI::App& app, Context& context) {
  auto words = std::make_shared<CostWords>();
  CLI::App* verb = app.add_subcommand("cost", "What accuracy costs: error against CPU time by every method, step and engine, drawn and read");
  verb->add_option("scene", words->scene, "A scene file, the bare name of one, a scene with a size, an assignment (a1, a2, a3): the student's module against the reference; or toi: root finders on times of impact")->required()->type_name("SCENE");
  verb->add_option("--methods", words->methods, "Methods of integration, with commas: euler, symplectic, midpoint, verlet, rk4, dopri5, fehlberg78, bulirsch-stoer, rosenbrock4 (implicit); none")->delimiter(',');
  verb->add_option("--engines", words->engines, "Beside rd with each method: auto (rd with closed forms), ca, tw; none")->delimiter(',');
  verb->add_option("--stabilisations", words->stabilisations, "What keeps rods and joints together, each with RK4: none, baumgarte, projection")->delimiter(',');
  verb->add_option("--impacts", words->impacts, "Which root finder looks for impacts, over its tolerance: bisection, newton, toms748")->delimiter(',');
  verb->add_option("--solvers", words->solvers, "Iterative solvers in place of direct ones, over their tolerance: gradients (rods and joints), sweeps (contacts without friction)")->delimiter(',');
  verb->add_option("--steps", words->steps, "Steps of the ladder [s], as 1/30,1/60,0.001, instead of halvings until the budget is used")->delimiter(',')->type_name("STEPS");
  verb->add_option("--tolerances", words->tolerances, "Tolerances of methods that control their error, instead of 0.1, 0.01, ...")->delimiter(',')->check(CLI::PositiveNumber);
  verb->add_option("--modules", words->modules, "Whose laws, as for tumble run; of an assignment: whose module is looked at (default student)")->type_name("WORDS");
  verb->add_option("--on", words->on, "Of an assignment: the scene that it is measured on")->type_name("SCENE");
  verb->add_option("--duration-s", words->duration_s, "Simulated time [s] instead of the scene's")->check(CLI::PositiveNumber);
  verb->add_option("--budget-s", words->budget_s, "CPU time of all ladders together [s]; the truth takes up to as much again")->capture_default_str()->check(CLI::PositiveNumber);
  verb->add_option("--n", words->n, "Size of a scene whose size is a parameter");
  verb->add_option("--out", words->out, "Folder in which the page SCENE/index.html is made")->capture_default_str();
  verb->footer("Example: tumble cost double_pendulum --modules reference\n         tumble cost a2 --modules mine/a2_integration.cpp\nTimes are CPU times in this run and are meant to be compared with each other only.");
  verb->callback([&context, words] { run_cost(context, *words); });
}

}  // namespace tumble::cli
