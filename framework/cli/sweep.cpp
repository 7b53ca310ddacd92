// tumble sweep SCENE --over WORD=VALUES: the scene for each point of a grid of values.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/planned_run.h"
#include "framework/cli/spread_words.h"
#include "framework/cli/sweep_page.h"
#include "framework/core/digest.h"
#include "framework/core/files.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

const std::string kUnit = "point";

struct SweepWords {
  RunWords run;
  std::vector<std::string> over, measures;
  SpreadWords spread;
  std::string out = "out/sweep";
  bool json = false;
};

/// The engines of all points: timewarp may need a module.
std::string engines_of(const SweepWords& words, const std::vector<Varied>& varied) {
  std::string engines = words.run.engine;
  for (const Varied& one : varied)
    if (one.word == "engine")
      for (const std::string& text : one.texts) engines += (engines.empty() ? "" : ",") + text;
  return engines;
}

/// A word that is varied and given for all is a contradiction.
void refuse_doubles(const SweepWords& words, const std::vector<Varied>& varied) {
  const std::vector<std::pair<std::string, bool>> given = {
      {"engine", !words.run.engine.empty()},
      {"method", !words.run.method.empty()},
      {"tolerance", words.run.tolerance.has_value()},
      {"step_s", words.run.step_s.has_value()}};
  for (const auto& [word, is_given] : given)
    for (const Varied& one : varied)
      if (one.word == word && is_given)
        throw UserError("--over " + word, "it is varied, and given for all runs too",
                        "Leave one of them out.");
  const bool has_method = !words.run.method.empty() ||
                          std::any_of(varied.begin(), varied.end(),
                                      [](const Varied& one) { return one.word == "method"; });
  for (const Varied& one : varied)
    if (one.word == "tolerance" && !has_method)
      throw UserError("--over tolerance", "no method is named that has one",
                      "For example --method dopri5.");
}

std::vector<std::string> words_of_task(const SweepWords& words) {
  std::vector<std::string> all = {"sweep", words.run.scene, "--out", words.out};
  for (const std::string& over : words.over) all.insert(all.end(), {"--over", over});
  if (!words.measures.empty()) {
    std::string list;
    for (const std::string& word : words.measures) list += (list.empty() ? "" : ",") + word;
    all.insert(all.end(), {"--measure", list});
  }
  const auto text = [&](const std::string& flag, const std::string& value) {
    if (!value.empty()) all.insert(all.end(), {flag, value});
  };
  const auto number = [&](const std::string& flag, const std::optional<double>& value) {
    if (value) all.insert(all.end(), {flag, fmt::format("{}", *value)});
  };
  text("--modules", words.run.modules);
  text("--engine", words.run.engine);
  text("--method", words.run.method);
  number("--tolerance", words.run.tolerance);
  number("--step-s", words.run.step_s);
  number("--duration-s", words.run.duration_s);
  if (words.run.n) all.insert(all.end(), {"--n", std::to_string(*words.run.n)});
  return all;
}

std::string made(const Context& context, const SweepWords& words, const Swept& swept,
                 const ChosenLaws& chosen_here, const std::string& engines, std::size_t index) {
  scene::Scene scene = swept.scene;
  RunWords run = words.run;
  set_scene(swept.varied, swept.points[index], scene);
  set_words(swept.varied, swept.points[index], run);
  // A sandbox answers one process, so that this one needs its own.
  if (chosen_here.connections.empty())
    return text_of(run_point(context, scene, chosen_here, run, swept.measures));
  const ChosenLaws own =
      choose_laws(context, swept.scene, parse_module_words(run.modules, context.registry), engines);
  return text_of(run_point(context, scene, own, run, swept.measures));
}

void print(const Swept& swept) {
  constexpr std::size_t kMostPrinted = 50;
  fmt::print("{}\n  {}\n", swept.scene.title, swept.laws);
  std::vector<std::size_t> widths;
  fmt::print(" ");
  for (const Varied& varied : swept.varied) {
    std::size_t widest = varied.word.size();
    for (std::size_t i = 0; i < varied.size(); ++i)
      widest = std::max(widest, value_in_words(varied, i).size());
    widths.push_back(widest);
    fmt::print(" {:>{}}", varied.word, widest);
  }
  for (const Measure& measure : swept.measures) {
    widths.push_back(std::max<std::size_t>(12, measure.word.size()));
    fmt::print(" {:>{}}", measure.word, widths.back());
  }
  fmt::print("  run\n");
  std::size_t printed = 0;
  for (std::size_t i = 0; i < swept.points.size(); ++i) {
    const PointResult& result = swept.results[i];
    if (++printed > kMostPrinted && result.state == PointState::kFine) continue;
    fmt::print(" ");
    for (std::size_t k = 0; k < swept.varied.size(); ++k)
      fmt::print(" {:>{}}", value_in_words(swept.varied[k], swept.points[i][k]), widths[k]);
    for (std::size_t k = 0; k < swept.measures.size(); ++k)
      fmt::print(" {:>{}.5g}", result.values.empty() ? kUnset : result.values[k],
                 widths[swept.varied.size() + k]);
    fmt::print("  {}{}{}\n", name_of(result.state), result.reason.empty() ? "" : ": ",
               result.reason);
  }
  if (swept.points.size() > kMostPrinted)
    fmt::print("  ... of {} points; table.csv has all\n", swept.points.size());
}

void run_sweep(Context& context, const SweepWords& words) {
  check(words.spread);
  Swept swept;
  swept.scene = find_scene(context, words.run.scene, words.run.n);
  swept.varied = parse_over(words.over, swept.scene);
  refuse_doubles(words, swept.varied);
  expect_engine("--engine ", words.run.engine);
  swept.measures = measures_of(words.measures, swept.scene);
  swept.points = grid_of(swept.varied);
  const ModuleWords module_words = parse_module_words(words.run.modules, context.registry);
  const std::string engines = engines_of(words, swept.varied);
  const ChosenLaws chosen = choose_laws(context, swept.scene, module_words, engines);
  for (const auto& notice : chosen.notices) fmt::print(stderr, "{}\n", notice);
  swept.laws = fmt::format("{}", fmt::join(authors_of_laws(swept.scene, chosen.laws), ", "));
  swept.laws[0] = 'I';  // of "impulses"
  // Words that contradict each other are refused before the first run, by a plan of each.
  std::set<std::pair<std::string, bool>> planned;
  for (const GridPoint& point : swept.points) {
    RunWords run = words.run;
    set_words(swept.varied, point, run);
    if (planned.emplace(run.method, run.tolerance.has_value()).second)
      plan_run(context, swept.scene, chosen, run);
  }

  std::string options = fmt::format(
      "sweep {} {} {} {} {} {} {}", words.run.n.value_or(0), words.run.engine, words.run.method,
      words.run.tolerance.value_or(0.0), words.run.step_s.value_or(0.0),
      words.run.duration_s.value_or(0.0), engines.find("tw") != std::string::npos);
  for (const Measure& measure : swept.measures) options += ' ' + measure.word;
  const fs::path folder = fs::path(words.out) / swept.scene.name;
  for (const char* file : {"index.html", "table.csv", "table.json", "times.json"})
    expect_writable(folder / file);
  farm::KeptParts parts(folder / "points", key_of(context, swept.scene, module_words, options));
  hold(words.spread, parts);
  farm::SplitWork work;
  work.unit = kUnit;
  constexpr std::size_t kDigits = 16;  // of a name: enough for 10^4 points
  for (const GridPoint& point : swept.points) {
    work.labels.push_back(in_words(swept.varied, point));
    work.names.push_back("point-" + digest(work.labels.back()).substr(0, kDigits));
  }
  work.make = [&](std::size_t index) {
    return made(context, words, swept, chosen, engines, index);
  };
  for (const std::string& name : work.names)
    if (const auto kept = parts.result(name); kept && point_of(*kept).may_pass) parts.forget(name);
  const farm::Outcome outcome = spread(context, words.spread, parts, work, words_of_task(words));
  if (!words.spread.shard.empty()) return end_shard(context, words.spread, outcome, kUnit);

  for (const std::string& name : work.names) {
    const auto text = parts.result(name);
    swept.results.push_back(text ? point_of(*text) : PointResult());
  }
  for (const farm::Lost& lost : outcome.lost)
    for (std::size_t i = 0; i < work.names.size(); ++i)
      if (work.names[i] == lost.name) swept.results[i].reason = lost.why;
  swept.lost = lost_in_words(outcome, kUnit);
  write_sweep(context, swept, folder);
  if (words.json) {
    nlohmann::ordered_json all = json_of(swept);
    all["page"] = (folder / "index.html").string();
    print_json(context, all);
  } else {
    print(swept);
    fmt::print("{}\n", (folder / "index.html").string());
  }
  if (!swept.lost.empty()) fmt::print(stderr, "tumble: {}\n", swept.lost);
  if (count_of(swept, PointState::kFine) < swept.points.size())
    context.exit = ExitCode::kCheckFailed;
}

}  // namespace

void add_sweep(CLI::App& app, Context& context) {
  auto words = std::make_shared<SweepWords>();
  Verb verb(app, "sweep",
            "Run a scene for each point of a grid of values, and plot what comes of it");
  verb.option("scene", words->run.scene,
              "A scene file, the bare name of one, or a scene with a size (atoms, cars, ...)")
      .required()
      .type_name("SCENE");
  verb.option("--over", words->over,
              "What is varied: WORD=START:END:STEP or WORD=VALUE,VALUE,...; several make a grid. "
              "Of all bodies restitution, friction; gravity, step_s, method, engine, tolerance; of "
              "one BODY.WHAT, with WHAT as \"sampling\" in a scene perturbs it: position_z_m, "
              "velocity_x_m_s, turn_x_rad, restitution, ...")
      .required()
      .one_each()
      .type_name("WORD=VALUES");
  verb.option("--measure", words->measures,
              "What is plotted: energy (its change), gap (the smallest), joint (the largest error "
              "of rods and joints), collisions, cpu, BODY.x, BODY.y, BODY.z (where it ends)")
      .separated_by(',')
      .type_name("WORD,...")
      .default_text("energy, gap, joint where there is one, cpu");
  verb.option("--n", words->run.n, "Size of a scene whose size is a parameter").positive();
  verb.option("--modules", words->run.modules, "Whose laws, as for tumble run").type_name("WORDS");
  verb.option("--engine", words->run.engine, "Of all runs, as for tumble run").type_name("WORD");
  verb.option("--method", words->run.method, "Of all runs, as for tumble run").type_name("WORD");
  verb.option("--tolerance", words->run.tolerance,
              "Of all runs by a method that chooses its steps by one")
      .positive();
  verb.option("--step-s", words->run.step_s, "Largest step [s] instead of the scene's").positive();
  verb.option("--duration-s", words->run.duration_s, "Simulated time [s] instead of the scene's")
      .positive();
  verb.option("--out", words->out, "Folder in which the page SCENE/index.html is made")
      .shows_default();
  add_spread_words(verb, words->spread, "points");
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Example: tumble sweep bouncing_ball --over restitution=0:1:0.05 --over step_s=1e-2,1e-3\n"
      "The same points give the same bytes of table.csv and table.json wherever they are made; "
      "times stand in times.json. What is finished lies in OUT/SCENE/points, and a second start "
      "takes it over. Points that stopped, cannot be trusted or are missing are marked with the "
      "reason.\n"
      "Exit: 0 every point is fine, 1 not every one, 2 something to repair, 4 not attempted.");
  verb.runs([&context, words] { run_sweep(context, *words); });
}

}  // namespace tumble::cli
