// tumble sample SCENE: worlds of a scene that do what is asked, by a Markov chain whose functions
// are an assignment's.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/planned_run.h"
#include "framework/cli/sample_files.h"
#include "framework/cli/sample_page.h"
#include "framework/cli/sandboxed_module.h"
#include "framework/cli/spread_words.h"
#include "framework/core/files.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/render/picture.h"
#include "framework/report/player.h"
#include "framework/sampling/kept_chain.h"
#include "framework/sampling/sampler.h"
#include "framework/scene/load_sampling.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using sampling::Answers;

const std::string kUnit = "chain";
constexpr int kPriorParts = 8;  // of worlds drawn from the prior: chains to compare

struct SampleWords {
  std::string scene, modules, engine;
  int chains = 4, samples = 300, warm_up = 100, prior = 0;
  int seed = 1;
  bool is_hard = false, json = false;
  std::optional<double> step_s, duration_s;
  std::string out = "out/sample";
  SpreadWords spread;
};

void tell(const std::string& what, int done, int all) {
  if (done == all || done % std::max(1, all / 4) == 0)
    fmt::print(stderr, "tumble: {}: {} of {}\n", what, done, all);
}

/// The module that provides the functions of a chain, by its word or as the scene has it.
void choose_sampler(const Context& context, const ModuleWords& words, Sampled& sampled) {
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const auto sampler = kind->note<sampling::Sampler>();
    if (!sampler.functions) continue;
    std::string word = "student";
    for (const ChosenModule& module : sampled.chosen.modules)
      if (module.id == kind->id && module.source != "library") word = module.source;
    const auto own = words.find(kind->id), all = words.find("");
    fs::path file;  // of a submission
    const auto is_path = [](const std::string& text) {
      return text != "student" && text != "reference" && text != "library";
    };
    if (own != words.end()) {
      word = own->second;
      if (is_path(word)) file = module_file(context, *kind, word);
    } else if (all != words.end() && all->second != "library") {
      if (is_path(all->second)) file = module_file(context, *kind, all->second, true);
      if (!is_path(all->second) || !file.empty()) word = all->second;
    }
    if (word == "library") refuse_library(*kind, "functions of a Markov chain");
    if (file.empty()) {
      sampled.by = sampler.functions(load_word(context, *kind, word));
    } else {
      const SandboxedModule sandboxed = load_sandboxed(context, *kind, file);
      sampled.by = sampler.functions(sandboxed.search.module);
      sampled.chosen.connections.push_back(sandboxed.search.connection);
    }
    sampled.source = kind->id + " " + word;
    return;
  }
  throw UserError(sampled.worlds.scene.name, "no assignment of this tree provides chains",
                  "It is assignment a5 of the course.");
}

/// All but the chains.
Sampled prepared(const Context& context, const SampleWords& words) {
  Sampled sampled;
  scene::Scene scene = find_scene(context, words.scene);
  const auto spec = scene::load_sampling(scene);
  if (!spec)
    throw UserError(words.scene, "this scene does not say in what its worlds differ",
                    "Add \"sampling\" to it, or take a scene that has it, such as ball_into_bin.");
  expect_engine("--engine ", words.engine);  // each world would be refused, as if it were broken
  const ModuleWords module_words = parse_module_words(words.modules, context.registry);
  sampled.chosen = choose_laws(context, scene, module_words, words.engine);
  sampled.worlds = {std::move(scene), *spec};
  choose_sampler(context, module_words, sampled);
  sampled.run.engine = words.engine;
  sampled.run.propagator = words.engine.empty() || words.engine == "rd" ? "auto" : "";
  sampled.run.timewarp = engines::fast_timewarp();
  sampled.run.step_s = words.step_s;
  sampled.run.duration_s = words.duration_s;
  sampled.run.command = context.command_line;
  sampled.names = sampling::names_of(sampled.worlds);
  sampled.options.seed = static_cast<std::uint64_t>(words.seed);
  sampled.options.samples = words.samples;
  sampled.options.warm_up = words.warm_up;
  sampled.options.is_hard = words.is_hard;
  sampled.options.progress = [](int chain, int step, int steps) {
    tell(fmt::format("chain {}", chain + 1), step, steps);
  };
  return sampled;
}

/// One chain, or the worlds of the prior behind the last of them, as text.
std::string made(const Context& context, const SampleWords& words, const Sampled& prepared_here,
                 std::size_t index) {
  // A sandbox answers one process, so that this one needs its own.
  std::optional<Sampled> own;
  if (!prepared_here.chosen.connections.empty()) own = prepared(context, words);
  const Sampled& sampled = own ? *own : prepared_here;
  const int number = static_cast<int>(index);
  if (number < words.chains)
    return text_of(sampling::run_chain(sampled.worlds, sampled.by, sampled.chosen.laws, sampled.run,
                                       sampled.options, number));
  return text_of(sampling::draw_prior(
      sampled.worlds, sampled.chosen.laws, sampled.run, sampled.options.seed, words.prior,
      [&](int done) { tell("worlds of the prior", done, words.prior); }));
}

/// The words of a task on another machine, which runs in this folder.
std::vector<std::string> words_of_task(const SampleWords& words) {
  std::vector<std::string> all = {"sample",    words.scene,
                                  "--chains",  std::to_string(words.chains),
                                  "--samples", std::to_string(words.samples),
                                  "--warm-up", std::to_string(words.warm_up),
                                  "--seed",    std::to_string(words.seed),
                                  "--prior",   std::to_string(words.prior),
                                  "--out",     words.out};
  if (words.is_hard) all.push_back("--hard");
  if (!words.modules.empty()) all.insert(all.end(), {"--modules", words.modules});
  if (!words.engine.empty()) all.insert(all.end(), {"--engine", words.engine});
  if (words.step_s) all.insert(all.end(), {"--step-s", fmt::format("{}", *words.step_s)});
  if (words.duration_s)
    all.insert(all.end(), {"--duration-s", fmt::format("{}", *words.duration_s)});
  return all;
}

/// Makes the chains, wherever it is to be, and their answers. Without answers where this is one
/// shard of them.
void sample(const Context& context, const SampleWords& words, const fs::path& folder,
            Sampled& sampled) {
  farm::KeptParts parts(
      folder / "chains",
      key_of(context, sampled.worlds.scene, parse_module_words(words.modules, context.registry),
             fmt::format("sample {} {} {} {} {} {} {}", words.samples, words.warm_up, words.seed,
                         words.is_hard, words.engine, words.step_s.value_or(0.0),
                         words.duration_s.value_or(0.0))));
  hold(words.spread, parts);
  farm::SplitWork work;
  work.unit = kUnit;
  for (int number = 1; number <= words.chains; ++number) {
    work.names.push_back(fmt::format("chain-{}", number));
    work.labels.push_back(fmt::format("chain {}", number));
  }
  if (words.prior > 0) {
    work.names.push_back(fmt::format("prior-{}", words.prior));
    work.labels.push_back("the worlds of the prior");
  }
  work.make = [&](std::size_t index) { return made(context, words, sampled, index); };
  sampled.outcome = spread(context, words.spread, parts, work, words_of_task(words));
  if (!words.spread.shard.empty()) return;

  for (int number = 0; number < words.chains; ++number)
    if (const auto text = parts.result(work.names[static_cast<std::size_t>(number)]))
      sampled.chains.push_back(sampling::chain_of(*text));
  if (sampled.chains.empty())
    throw UserError(folder.string(),
                    "no chain came to its end: " + lost_in_words(sampled.outcome, kUnit),
                    "See what ended the processes; with --jobs 1 they take less memory.");
  sampled.growing = sampling::growing_answers(sampled.by, sampled.names, sampled.chains);
  if (words.prior == 0) return;
  if (const auto text = parts.result(work.names.back())) {
    sampled.prior = sampling::chain_of(*text);
    sampled.prior_growing = sampling::growing_answers(sampled.by, sampled.names,
                                                      sampling::cut(*sampled.prior, kPriorParts));
  }
}

void print(const Sampled& sampled) {
  const Answers& answers = sampled.growing.back();
  fmt::print("{}\n  chains by {} · {}\n", sampled.worlds.scene.title, sampled.source,
             fmt::join(authors_of_laws(sampled.worlds.scene, sampled.chosen.laws), " · "));
  fmt::print(
      "  {} of {} samples do what is asked; {:.0f} % of proposals accepted; largest R-hat {:.3f}\n",
      answers.done, answers.samples, 100 * answers.acceptance, answers.worst_r_hat);
  fmt::print(
      "  {} simulations in {:.3g} s of CPU time: {:.3g} samples, {:.3g} effective ones a "
      "second\n",
      answers.simulations, answers.cpu_s, answers.samples / answers.cpu_s,
      answers.least_effective / answers.cpu_s);
  fmt::print("  {:<34} {:>24} {:>10} {:>8}", "among the worlds that do it", "mean", "effective",
             "R-hat");
  if (sampled.prior) fmt::print(" {:>24} {:>8}", "by the prior alone", "apart");
  fmt::print("\n");
  for (std::size_t i = 0; i < answers.estimates.size(); ++i) {
    const sampling::Estimate& estimate = answers.estimates[i];
    // The sign of the error is two bytes wide.
    fmt::print("  {:<34} {:>24} {:>10.0f} {:>8.3f}", estimate.name, with_error(estimate.answer),
               estimate.answer.effective_samples, estimate.r_hat);
    if (sampled.prior) {
      const Answer& other = sampled.prior_growing.back().estimates[i].answer;
      fmt::print(" {:>24} {:>8.1f}", with_error(other), errors_apart(estimate.answer, other));
    }
    fmt::print("\n");
  }
}

/// Where worlds cannot be drawn, chains may be made nevertheless: their page may be made elsewhere,
/// and has no picture where every world broke.
void warn_of_page() {
  try {
    render::expect_pictures();
    report::expect_player();
  } catch (const UserError& error) {
    fmt::print(stderr,
               "tumble: {}: {}: here the page may fail. Chains and their answers are kept, and the "
               "same command makes the page on a machine that can draw\n",
               error.where(), error.problem());
  }
}

void run_sample(Context& context, const SampleWords& words) {
  check(words.spread);
  constexpr int kLeastPrior = 8 * kPriorParts;  // of a part: the least that answers are made of
  if (words.prior > 0 && words.prior < kLeastPrior)
    throw UserError("--prior", fmt::format("{} worlds are too few to compare with", words.prior),
                    fmt::format("Draw at least {}.", kLeastPrior));
  Sampled sampled = prepared(context, words);
  for (const auto& notice : sampled.chosen.notices) fmt::print(stderr, "{}\n", notice);
  const fs::path folder = fs::path(words.out) / sampled.worlds.scene.name;
  for (const char* file : {"index.html", "answers.json", "times.json", "chains.csv"})
    expect_writable(folder / file);
  if (words.spread.shard.empty()) warn_of_page();  // which is made here
  sample(context, words, folder, sampled);
  if (!words.spread.shard.empty()) return end_shard(context, words.spread, sampled.outcome, kUnit);
  const std::string lost = lost_in_words(sampled.outcome, kUnit);
  write_sample_files(context, sampled, folder);
  write_sample_page(context, sampled, folder);
  const Answers& answers = sampled.growing.back();
  if (words.json) {
    ordered_json parts = {{"scene", sampled.worlds.scene.name},
                          {"chains", words.chains},
                          {"seed", words.seed},
                          {"functions", sampled.source},
                          {"lost", ordered_json::array()},
                          {"answers", json_of(answers)},
                          {"doubts", sampling::doubts(answers, sampled.chains.size())}};
    for (const farm::Lost& one : sampled.outcome.lost) parts["lost"].push_back(one.name);
    if (sampled.prior) parts["prior"] = json_of(sampled.prior_growing.back());
    parts["times"] = times_of(answers);
    if (sampled.prior) parts["times_of_prior"] = times_of(sampled.prior_growing.back());
    parts["page"] = (folder / "index.html").string();
    print_json(context, parts);
  } else {
    print(sampled);
    for (const std::string& doubt : sampling::doubts(answers, sampled.chains.size()))
      fmt::print("  {}\n", doubt);
    fmt::print("{}\n", (folder / "index.html").string());
  }
  if (!lost.empty()) fmt::print(stderr, "tumble: {}\n", lost);
  if (!sampling::can_be_used(answers) || !lost.empty()) context.exit = ExitCode::kCheckFailed;
}

}  // namespace

void add_sample(CLI::App& app, Context& context) {
  auto words = std::make_shared<SampleWords>();
  Verb verb(
      app, "sample",
      "Sample the worlds of a scene that do what is asked of them, and say how far the answers "
      "can be trusted");
  verb.option("scene", words->scene,
              "A scene file, or the bare name of one, that says in what its worlds differ")
      .required()
      .type_name("SCENE");
  verb.option("--chains", words->chains, "Markov chains, each from a start of its own")
      .between(1, 1000)
      .shows_default();
  verb.option("--samples", words->samples, "Samples of each chain that are kept")
      .between(8, 1000000)
      .shows_default();
  verb.option("--warm-up", words->warm_up, "Steps of each chain before the first that is kept")
      .between(0, 1000000)
      .shows_default();
  verb.option("--seed", words->seed, "The same seed gives the same chains")
      .not_negative()
      .shows_default();
  verb.flag("--hard", words->is_hard,
            "What is asked is all or nothing: violations have no softness");
  verb.option("--prior", words->prior,
              "Draw so many worlds from the prior too, to compare: those count that happen to do "
              "what is asked")
      .between(0, 10000000)
      .shows_default();
  verb.option("--modules", words->modules, "Whose functions and laws, as for tumble run")
      .type_name("WORDS");
  verb.option("--engine", words->engine, "As for tumble run").type_name("WORD");
  verb.option("--step-s", words->step_s, "Largest step [s] instead of the scene's").positive();
  verb.option("--duration-s", words->duration_s, "Simulated time [s] instead of the scene's")
      .positive();
  verb.option("--out", words->out, "Folder in which the page SCENE/index.html is made")
      .shows_default();
  add_spread_words(verb, words->spread, "chains");
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Example: tumble sample ball_into_bin --prior 2000\n"
      "The same chains give the same bytes of chains.csv and answers.json wherever they are made. "
      "What is finished lies in OUT/SCENE/chains, and a second start takes it over.\n"
      "Exit: 0 worlds were found, 1 the answers are not to be trusted (no world does what is "
      "asked, "
      "R-hat above 1.1, many broken runs) or a chain is missing, 2 something to repair, 4 not "
      "attempted.");
  verb.runs([&context, words] { run_sample(context, *words); });
}

}  // namespace tumble::cli
