// tumble engines SCENE: the same scene by every engine, with counters, agreement, and relative
// times.
// Without a scene: the course's scenes on one page (engines_all).
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "framework/cli/engine_rows.h"
#include "framework/cli/engines_all.h"
#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/kept_at_stop.h"
#include "framework/cli/record.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/report/tables_json.h"
#include "framework/scene/sized_scenes.h"

namespace tumble::cli {
namespace {

using report::EngineRow;

/// @param each  called after each engine with the rows so far
std::vector<EngineRow> run_all(const Context& context, const scene::Scene& scene,
                               const ChosenLaws& chosen, const EnginesWords& words,
                               const std::function<void(const std::vector<EngineRow>&)>& each) {
  std::vector<EngineRun> runs;
  for (EngineChoice& choice : engines_named(words.engines)) {
    std::fprintf(stderr, "tumble: %s by %s\n", scene.name.c_str(), choice.engine.c_str());
    choice.propagator = words.propagator;
    choice.step_s = words.step_s;
    choice.duration_s = words.duration_s;
    choice.threads = words.threads;
    choice.by_the_clock = words.threads > 1;
    runs.push_back(measure_engine(context, scene, chosen, choice));
    tell_agreement(runs);
    each(rows_of(runs));
  }
  return rows_of(runs);
}

void run_engines(Context& context, const EnginesWords& words) {
  if (words.scene.empty() || words.scene == kAllScenes) return engines_of_all(context, words);
  if (words.full || words.small || words.no_videos)
    throw UserError(words.full    ? "--full"
                    : words.small ? "--small"
                                  : "--no-videos",
                    "belongs to the page of all scenes", "Leave it out, or leave the scene out.");
  const scene::Scene scene = find_scene(context, words.scene, words.n);
  const ChosenLaws chosen = choose_laws(
      context, scene, parse_module_words(words.modules, context.registry), words.engines);
  refuse_threads_of_sandboxes(chosen, words.threads);
  if (!words.propagator.empty() && words.propagator != "laws" && words.propagator != "auto")
    throw UserError("--propagator " + words.propagator, "is none of laws and auto",
                    "For example --propagator auto.");
  for (const auto& notice : chosen.notices) fmt::print(stderr, "{}\n", notice);
  std::vector<std::vector<EngineRow>> ladder;
  if (!words.sizes.empty() && scene::sized_scene_named(words.scene) == nullptr)
    throw UserError("--sizes", fmt::format("'{}' has one size", words.scene),
                    "Give a scene whose size is a parameter, such as atoms, or leave --sizes out.");
  const std::filesystem::path page = std::filesystem::path(words.out) / scene.name / "index.html";
  expect_writable(page);
  for (const int n : words.sizes) find_scene(context, words.scene, n);  // refused before any run
  KeptAtStop stop("runs");
  const bool runs_own_size = words.sizes.empty() || words.n;
  const std::size_t all = engines_named(words.engines).size() *
                          (words.sizes.size() + static_cast<std::size_t>(runs_own_size));
  std::size_t done = 0;
  // the table is of the last size that is run
  const scene::Scene shown =
      runs_own_size ? scene : find_scene(context, words.scene, words.sizes.back());
  const auto keep = [&](const std::vector<EngineRow>& so_far) {
    stop.keep(++done, all, page.string(), [&] {
      report::write_engines_page(shown.title, shown.about, so_far, ladder,
                                 record_of(context, shown), page);
    });
  };
  for (const int n : words.sizes) {
    ladder.push_back(run_all(context, find_scene(context, words.scene, n), chosen, words, keep));
    if (words.json) continue;
    fmt::print("n = {}\n", n);
    print_rows(ladder.back());
  }
  const std::vector<EngineRow> rows =
      runs_own_size ? run_all(context, scene, chosen, words, keep) : ladder.back();
  report::write_engines_page(shown.title, shown.about, rows, ladder, record_of(context, shown),
                             page);
  if (words.json) {
    nlohmann::ordered_json sizes = nlohmann::ordered_json::array();
    for (const std::vector<EngineRow>& of_size : ladder)
      sizes.push_back({{"n", of_size.front().bodies}, {"engines", report::json_of(of_size)}});
    print_json(context, {{"scene", scene.name},
                         {"title", shown.title},
                         {"engines", report::json_of(rows)},
                         {"sizes", std::move(sizes)},
                         {"page", page.string()}});
  } else {
    fmt::print("{}\n  {}\n", shown.title, fmt::join(authors_of_laws(scene, chosen.laws), " · "));
    print_rows(rows);
    fmt::print("{}\n", page.string());
  }
  if (std::all_of(rows.begin(), rows.end(),
                  [](const EngineRow& row) { return row.counts.empty(); })) {
    fmt::print(stderr, "tumble: no engine ran\n");
    context.exit = ExitCode::kUserError;
  }
  for (const EngineRow& row : rows)
    if ((!row.counts.empty() && !row.stopped_by.empty()) || !row.faults.empty())
      context.exit = ExitCode::kCheckFailed;
}

}  // namespace

void add_engines(CLI::App& app, Context& context) {
  auto words = std::make_shared<EnginesWords>();
  Verb verb(app, "engines",
            "Run a scene by every engine and compare what they count, commit and cost");
  verb.option("scene", words->scene,
              "A scene file, the bare name of one, or a scene with a size (atoms, cars, ...); "
              "none, or all: the course's scenes on one page")
      .type_name("SCENE");
  verb.flag("--full", words->full, "Of the page of all scenes: sizes as in the paper; takes long");
  verb.flag("--small", words->small,
            "Of the page of all scenes: four of them, smaller still; takes seconds")
      .excludes("--full");
  verb.flag("--no-videos", words->no_videos,
            "Of the page of all scenes: tables, plots and players only");
  verb.option("--n", words->n, "Size of a scene whose size is a parameter").positive();
  verb.option("--sizes", words->sizes,
              "Sizes to run one after the other: draws work and time against n, e.g. --sizes "
              "50,100,200")
      .separated_by(',');
  verb.option("--engines", words->engines,
              "Which, with commas between them; ordered is the reference that goes event by event")
      .shows_default();
  verb.option("--propagator", words->propagator,
              "Of rd: laws, or auto (closed forms, as the other engines have)")
      .type_name("WORD");
  verb.option("--modules", words->modules, "Whose laws, as for tumble run").type_name("WORDS");
  verb.option("--duration-s", words->duration_s, "Simulated time [s] instead of the scene's")
      .positive();
  verb.option("--step-s", words->step_s, "Largest step [s] instead of the scene's").positive();
  verb.option("--threads", words->threads, "Of tw: how many; then times are by the clock")
      .between(1, 64)
      .shows_default();
  verb.option("--out", words->out,
              "Folder in which pages are made: index.html of all scenes, SCENE/index.html of one")
      .shows_default();
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Example: tumble engines\n         tumble engines atoms --sizes 30,100,300\nTimes are CPU "
      "times in this run (by the clock with --threads) and are meant to be compared with each "
      "other only.");
  verb.runs([&context, words] { run_engines(context, *words); });
}

}  // namespace tumble::cli
