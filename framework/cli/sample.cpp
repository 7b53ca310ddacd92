// tumble sample SCENE: worlds of a scene that do what is asked, by a Markov chain whose functions
// are an assignment's.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/sample_page.h"
#include "framework/cli/sandboxed_module.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/sampling/sampler.h"
#include "framework/scene/load_sampling.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using sampling::Answers;

constexpr int kPriorParts = 8;  // of worlds drawn from the prior: chains to compare

struct SampleWords {
  std::string scene, modules, engine;
  int chains = 4, samples = 300, warm_up = 100, prior = 0;
  int seed = 1;
  bool is_hard = false, json = false;
  std::optional<double> step_s, duration_s;
  std::string out = "out/sample";
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
      if (module.id == kind->id) word = module.source;
    const auto own = words.find(kind->id), all = words.find("");
    if (own != words.end())
      word = own->second;
    else if (all != words.end() && all->second != "library")
      word = all->second;
    if (word == "student" || word == "reference") {
      sampled.by = sampler.functions(load_word(context, *kind, word));
    } else {
      const SandboxedModule sandboxed = load_sandboxed(context, *kind, word);
      sampled.by = sampler.functions(sandboxed.search.module);
      sampled.chosen.connections.push_back(sandboxed.search.connection);
    }
    sampled.source = kind->id + " " + word;
    return;
  }
  throw UserError(sampled.worlds.scene.name, "no assignment of this tree provides chains",
                  "It is assignment a5 of the course.");
}

Sampled sample(const Context& context, const SampleWords& words) {
  Sampled sampled;
  scene::Scene scene = find_scene(context, words.scene);
  const auto spec = scene::load_sampling(scene);
  if (!spec)
    throw UserError(words.scene, "this scene does not say in what its worlds differ",
                    "Add \"sampling\" to it, or take a scene that has it, such as ball_into_bin.");
  const ModuleWords module_words = parse_module_words(words.modules, context.registry);
  sampled.chosen = choose_laws(context, scene, module_words, words.engine);
  for (const auto& notice : sampled.chosen.notices) fmt::print(stderr, "{}\n", notice);
  sampled.worlds = {std::move(scene), *spec};
  choose_sampler(context, module_words, sampled);
  sampled.run.engine = words.engine;
  sampled.run.propagator = words.engine.empty() || words.engine == "rd" ? "auto" : "";
  sampled.run.timewarp = engines::fast_timewarp();
  sampled.run.step_s = words.step_s;
  sampled.run.duration_s = words.duration_s;
  sampled.run.command = context.command_line;
  sampled.names = sampling::names_of(sampled.worlds);

  sampling::ChainOptions options;
  options.seed = static_cast<std::uint64_t>(words.seed);
  options.samples = words.samples;
  options.warm_up = words.warm_up;
  options.is_hard = words.is_hard;
  options.progress = [](int chain, int step, int steps) {
    tell(fmt::format("chain {}", chain + 1), step, steps);
  };
  for (int number = 0; number < words.chains; ++number)
    sampled.chains.push_back(sampling::run_chain(sampled.worlds, sampled.by, sampled.chosen.laws,
                                                 sampled.run, options, number));
  sampled.growing = sampling::growing_answers(sampled.by, sampled.names, sampled.chains);
  if (words.prior > 0) {
    sampled.prior = sampling::draw_prior(
        sampled.worlds, sampled.chosen.laws, sampled.run, options.seed, words.prior,
        [&](int done) { tell("worlds of the prior", done, words.prior); });
    sampled.prior_growing = sampling::growing_answers(sampled.by, sampled.names,
                                                      sampling::cut(*sampled.prior, kPriorParts));
  }
  return sampled;
}

ordered_json json_of(const Answer& answer) {
  ordered_json json;
  json["mean"] = answer.mean;
  json["deviation"] = answer.deviation;
  json["effective_samples"] = answer.effective_samples;
  json["standard_error"] = answer.standard_error;
  return json;
}

ordered_json json_of(const Answers& answers) {
  ordered_json json;
  json["samples"] = answers.samples;
  json["done"] = answers.done;
  json["simulations"] = answers.simulations;
  json["broken"] = answers.broken;
  json["acceptance"] = answers.acceptance;
  json["worst_r_hat"] = answers.worst_r_hat;
  json["share_done"] = json_of(answers.share);
  json["numbers"] = ordered_json::array();
  for (const sampling::Estimate& estimate : answers.estimates) {
    ordered_json one = json_of(estimate.answer);
    one["r_hat"] = estimate.r_hat;
    one["name"] = estimate.name;
    json["numbers"].push_back(one);
  }
  return json;
}

ordered_json times_of(const Answers& answers) {
  ordered_json json;
  json["cpu_s"] = answers.cpu_s;
  json["samples_a_second"] = answers.samples / answers.cpu_s;
  json["simulations_a_second"] = answers.simulations / answers.cpu_s;
  json["effective_samples_a_second"] = answers.least_effective / answers.cpu_s;
  return json;
}

void print(const Sampled& sampled) {
  const Answers& answers = sampled.growing.back();
  fmt::print("{}\n  chains by {} · impulses by {} · motion by {}\n", sampled.worlds.scene.title,
             sampled.source, sampled.chosen.laws.impulse_source,
             sampled.chosen.laws.integrator_source);
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

void run_sample(Context& context, const SampleWords& words) {
  const Sampled sampled = sample(context, words);
  const fs::path folder = fs::path(words.out) / sampled.worlds.scene.name;
  write_sample_page(context, sampled, folder);
  const Answers& answers = sampled.growing.back();
  if (words.json) {
    ordered_json parts = {{"scene", sampled.worlds.scene.name},
                          {"chains", words.chains},
                          {"seed", words.seed},
                          {"functions", sampled.source},
                          {"answers", json_of(answers)}};
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
  if (answers.done == 0) context.exit = ExitCode::kCheckFailed;
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
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Example: tumble sample ball_into_bin --prior 2000\nExit: 0 worlds were found, 1 none does "
      "what is asked, 2 something to repair, 4 not attempted.");
  verb.runs([&context, words] { run_sample(context, *words); });
}

}  // namespace tumble::cli
