#include "framework/cli/cost_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/record.h"
#include "framework/cli/sandboxed_module.h"
#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/cost/showcase.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/report/cost_page.h"
#include "framework/report/html.h"
#include "framework/sampling/accuracy.h"
#include "framework/sampling/sampler.h"
#include "framework/scene/load_sampling.h"

namespace tumble::cli {
namespace {

using sampling::AccuracyPoint;
using sampling::Answers;
using sampling::Chain;

constexpr double kMark = 0.1;         // deviations: an answer to a tenth of its spread
constexpr int kChains = 6;            // of each way: their errors are averaged
constexpr int kProbes = 10;           // worlds run to see what one costs
constexpr double kForTheTruth = 0.4;  // of the budget: worlds of the prior
constexpr int kLeastSamples = 16;     // of a chain, however small the budget
constexpr int kLeastDone = 30;        // of the truth: below, its own error hides that of the ways
constexpr double kWarmUp = 0.2;       // of a chain's steps
constexpr double kFewerSteps = 1.0 / 3.0, kLargerSteps = 3.0;
constexpr std::uint64_t kSeed = 1, kSeedOfTheTruth = 2;

/// One curve: brute force, or chains of one kind.
struct Trial {
  std::string name;
  Sampling by;  // no functions: worlds of the prior
  double step_factor = 1.0;
  bool has_wide_steps = true, is_hard = false;
  std::vector<Chain> chains;
  std::vector<AccuracyPoint> points;
  Answers answers;
  std::string problem;  // why it has no curve
  bool is_chain() const { return static_cast<bool>(by.metropolis_step); }
};

std::string unused_words(const CostWords& words) {
  if (!words.methods.empty()) return "--methods";
  if (!words.engines.empty()) return "--engines";
  if (!words.stabilisations.empty()) return "--stabilisations";
  if (!words.coordinates.empty()) return "--coordinates";
  if (!words.impacts.empty()) return "--impacts";
  if (!words.solvers.empty()) return "--solvers";
  if (!words.steps.empty()) return "--steps";
  return words.tolerances.empty() ? "" : "--tolerances";
}

/// What all ways share.
struct Subject {
  sampling::SampledScene worlds;
  ChosenLaws chosen;
  engines::RunOptions run;
  std::vector<std::string> names;
};

/// @param word  whose functions of a chain: no law is among them, and a file of another word need
///   not be there
Subject subject_of(const Context& context, const modules::ModuleKind& kind, const std::string& word,
                   const CostWords& words) {
  Subject subject;
  const std::string name = words.on.empty() ? kind.note<cost::CostShowcase>().scene : words.on;
  scene::Scene scene = find_scene(context, name, words.n);
  const auto spec = scene::load_sampling(scene);
  if (!spec)
    throw UserError(name, "this scene does not say in what its worlds differ",
                    "Add \"sampling\" to it, or take a scene that has it: --on ball_into_bin");
  subject.chosen = choose_laws(context, scene, {{kind.id, word}});
  for (const std::string& notice : subject.chosen.notices) fmt::print(stderr, "{}\n", notice);
  subject.worlds = {std::move(scene), *spec};
  subject.run.propagator = "auto";
  subject.run.timewarp = engines::fast_timewarp();
  subject.run.duration_s = words.duration_s;
  subject.run.command = context.command_line;
  subject.names = sampling::names_of(subject.worlds);
  return subject;
}

/// The functions of a module by its word; a sandbox's connection is kept with the laws'.
Sampling functions_of(const Context& context, const modules::ModuleKind& kind,
                      const std::string& word, Subject& subject) {
  const auto sampler = kind.note<sampling::Sampler>();
  if (word == "student" || word == "reference")
    return sampler.functions(load_word(context, kind, word));
  const SandboxedModule sandboxed = load_sandboxed(context, kind, module_file(context, kind, word));
  subject.chosen.connections.push_back(sandboxed.search.connection);
  return sampler.functions(sandboxed.search.module);
}

std::vector<Trial> ways_of(const Sampling& yours, const std::string& whose) {
  std::vector<Trial> ways(5);
  for (Trial& way : ways) way.by = yours;
  ways[0].name = whose + " chain, tempered, mixed proposal";
  ways[1].name = whose + " chain, tempered, plain proposal";
  ways[1].has_wide_steps = false;
  ways[2].name = whose + " chain, tempered, mixed, steps of a third";
  ways[2].step_factor = kFewerSteps;
  ways[3].name = whose + " chain, tempered, mixed, three times the steps";
  ways[3].step_factor = kLargerSteps;
  ways[4].name = whose + " chain, hard, plain proposal";
  ways[4].has_wide_steps = false;
  ways[4].is_hard = true;
  return ways;
}

void run_trial(Trial& way, const Subject& subject, int samples, const Answers& truth) {
  sampling::SampledScene worlds = subject.worlds;
  for (scene::PerturbationSpec& one : worlds.sampling.perturbed) one.step *= way.step_factor;
  if (!way.has_wide_steps) worlds.sampling.wide_share = 0.0;
  sampling::ChainOptions options;
  options.seed = kSeed;
  options.warm_up = static_cast<int>(kWarmUp * samples);
  options.samples = samples - options.warm_up;
  options.is_hard = way.is_hard;
  try {
    for (int number = 0; number < kChains; ++number)
      way.chains.push_back(
          sampling::run_chain(worlds, way.by, subject.chosen.laws, subject.run, options, number));
    way.answers = sampling::answers_of(way.by, subject.names, way.chains, options.samples);
    way.points = sampling::accuracy_of(way.chains, truth);
    if (way.points.empty())
      way.problem = "one of its chains found no world that does what is asked";
  } catch (const UserError& error) {  // no possible start
    way.problem = error.what();
  }
  fmt::print(stderr, "tumble: {}: {}\n", way.name,
             way.problem.empty() ? fmt::format("error {:.2g} deviations after {} samples, {}",
                                               way.points.back().error, way.points.back().samples,
                                               report::price_of(way.points.back().cpu_s))
                                 : way.problem);
}

/// The prior's worlds in as many parts as other ways have chains.
Trial brute_force(const Sampling& by, const Subject& subject, const Chain& drawn,
                  const Answers& truth) {
  Trial way;
  way.name = "brute force: worlds of the prior";
  way.chains = sampling::cut(drawn, kChains);
  way.answers = sampling::answers_of(by, subject.names, way.chains,
                                     static_cast<int>(way.chains.front().x.rows()));
  way.points = sampling::accuracy_of(way.chains, truth);
  // The truth holds each part: the deviation about a mean of n parts is sqrt((n - 1)/n) too small.
  for (AccuracyPoint& point : way.points)
    point.error *= std::sqrt(kChains / static_cast<double>(kChains - 1));
  if (way.points.empty()) way.problem = "a part of them holds no world that does what is asked";
  return way;
}

report::Plot plot_of(const std::vector<Trial>& ways, double floor) {
  report::Plot plot{"Error of an answer against CPU time",
                    {"CPU time of a chain", "s", report::Scale::kLog},
                    {"error of the means", "deviations", report::Scale::kLog},
                    {},
                    {},
                    "Left is cheaper, down is more accurate. Every way that finds its worlds falls "
                    "with slope -1/2 in the end, so one digit more costs a hundred times as much; "
                    "what a method changes is how far left its line is."};
  for (const Trial& way : ways) {
    report::Curve curve{way.points.empty() ? "" : way.name, {}, {}, true};
    for (const AccuracyPoint& point : way.points) {
      curve.x.push_back(point.cpu_s);
      curve.y.push_back(point.error);
    }
    plot.curves.push_back(std::move(curve));
  }
  if (std::isfinite(floor)) plot.limits.push_back({floor, "error of the reference solution"});
  return plot;
}

std::string digits_of(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "\u2013";
}

report::Table table_of(const std::vector<Trial>& ways) {
  report::Table table;
  table.caption = fmt::format(
      "CPU time for an error of {} deviations, from the last point of each curve by the law error "
      "~ 1/sqrt(time). Of a way whose R-hat is far above 1 the price says too little: its chains "
      "have not met.",
      kMark);
  table.columns = {{""},
                   {fmt::format("for {} deviations", kMark), true},
                   {"error reached", true},
                   {"in", true},
                   {"slope", true},
                   {"worlds that do it", true},
                   {"accepted", true},
                   {"R-hat", true}};
  bool has_problem = false;
  for (const Trial& way : ways) {
    if (way.points.empty()) {
      has_problem = true;
      table.rows.push_back({{way.name}, {"\u2013", "", report::Look::kMuted}});
      table.rows.back().resize(table.columns.size());
      table.rows.back().push_back({way.problem, "", report::Look::kMuted});
      continue;
    }
    table.rows.push_back(
        {{way.name},
         {report::price_of(sampling::price_of(way.points, kMark))},
         {fmt::format("{:.2g}", way.points.back().error)},
         {report::price_of(way.points.back().cpu_s)},
         {digits_of(sampling::slope_of(way.points), 2)},
         {fmt::format("{:.0f} %", 100.0 * way.answers.done / std::max(1, way.answers.samples))},
         {way.is_chain() ? fmt::format("{:.0f} %", 100.0 * way.answers.acceptance) : "\u2013"},
         {digits_of(way.answers.worst_r_hat, 3), "",
          way.answers.worst_r_hat < 1.05 ? report::Look::kPlain : report::Look::kWarning}});
  }
  if (has_problem) {  // a sentence: in a column of numbers it would not break
    table.columns.push_back({"why without a price"});
    for (auto& row : table.rows) row.resize(table.columns.size());
  }
  return table;
}

/// The page in two sentences: the cheapest of the module's chains, and when it pays.
std::vector<std::string> readings_of(const std::vector<Trial>& ways, const Answers& truth) {
  const Trial& brute = ways.back();
  const Trial* best = nullptr;
  for (const Trial& way : ways)
    if (way.is_chain() && !way.points.empty() &&
        (best == nullptr ||
         sampling::price_of(way.points, kMark) < sampling::price_of(best->points, kMark)))
      best = &way;
  if (best == nullptr) return {"No chain found worlds that do what is asked."};
  const double chain = sampling::price_of(best->points, kMark),
               prior = sampling::price_of(brute.points, kMark),
               share = static_cast<double>(truth.done) / truth.samples;
  std::vector<std::string> readings{fmt::format(
      "An answer to a tenth of its spread costs {} of CPU time by the cheapest chain ({}){}; one "
      "digit more costs a hundred times as much.",
      report::price_of(chain), best->name,
      brute.points.empty()
          ? ", and brute force has no answer yet"
          : fmt::format(" and {} by brute force, {:.2g} times {}", report::price_of(prior),
                        std::max(prior / chain, chain / prior),
                        prior >= chain ? "as much" : "less"))};
  if (std::isfinite(prior) && share > 0.0)
    readings.push_back(fmt::format(
        "Of the worlds of the prior {:.2g} % do what is asked. Brute force pays for all the "
        "others, so its price rises as they get rarer; that of a chain rises little. At these "
        "prices a chain pays where fewer than about 1 world in {:.0f} does it.",
        100.0 * share, std::max(1.0, chain / prior / share)));
  return readings;
}

nlohmann::ordered_json json_of(const std::vector<Trial>& ways) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Trial& way : ways) {
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const AccuracyPoint& point : way.points)
      points.push_back(
          {{"samples", point.samples}, {"cpu_s", point.cpu_s}, {"error", point.error}});
    all.push_back({{"name", way.name},
                   {"price_s", sampling::price_of(way.points, kMark)},
                   {"slope", sampling::slope_of(way.points)},
                   {"done", way.answers.done},
                   {"samples", way.answers.samples},
                   {"acceptance", way.answers.acceptance},
                   {"worst_r_hat", way.answers.worst_r_hat},
                   {"problem", way.problem},
                   {"points", std::move(points)}});
  }
  return all;
}

void print_table(const report::Table& table) {
  std::size_t longest = 0;
  for (const auto& row : table.rows) longest = std::max(longest, row.front().text.size());
  const auto print_row = [&](const auto& text_of) {
    fmt::print("{:<{}}", text_of(0), longest);
    for (std::size_t i = 1; i < table.columns.size(); ++i) fmt::print("  {:>17}", text_of(i));
    fmt::print("\n");
  };
  print_row([&](std::size_t i) { return table.columns[i].name; });
  for (const auto& row : table.rows)
    print_row([&](std::size_t i) { return i < row.size() ? row[i].text : ""; });
}

}  // namespace

void cost_of_sampling(Context& context, const modules::ModuleKind& kind, const CostWords& words) {
  if (const std::string flag = unused_words(words); !flag.empty())
    throw UserError(flag,
                    "a chain chooses among worlds, not among methods of motion, so this changes "
                    "nothing in tumble cost " +
                        kind.id,
                    "Leave it out. What can be chosen: --modules, --on SCENE, --duration-s, "
                    "--budget-s.");
  const std::string word = words.modules.empty() ? "student" : words.modules;
  if (word == "library") refuse_library(kind, "functions of a Markov chain");
  Subject subject = subject_of(context, kind, word, words);
  const Sampling yours = functions_of(context, kind, word, subject);
  const bool has_reference =
      std::filesystem::exists(context.build / "modules" / (kind.id + "_reference.so"));
  // Errors are judged by right functions where there are some.
  const Sampling judge = has_reference ? functions_of(context, kind, "reference", subject) : yours;
  std::vector<Trial> ways = ways_of(yours, word == "reference" ? "reference" : "your");
  if (has_reference && word != "reference") {
    ways.emplace_back();
    ways.back().name = "reference, tempered, mixed proposal";
    ways.back().by = judge;
  }

  // The truth: worlds of the prior, for a part of the budget.
  const Chain probe =
      sampling::draw_prior(subject.worlds, subject.chosen.laws, subject.run, kSeed, kProbes);
  const double a_world_s = probe.cpu_s[kProbes - 1] / kProbes;
  const auto worlds_for = [&](double seconds) {
    return std::max(kLeastSamples, static_cast<int>(seconds / a_world_s));
  };
  const int draws = std::max(kChains * kLeastSamples, worlds_for(kForTheTruth * words.budget()));
  fmt::print(stderr, "tumble: {} of CPU time for a world: the truth by {} worlds of the prior\n",
             report::price_of(a_world_s), draws);
  const Chain drawn = sampling::draw_prior(subject.worlds, subject.chosen.laws, subject.run,
                                           kSeedOfTheTruth, draws);
  const std::vector<Chain> parts = sampling::cut(drawn, kChains);
  Answers truth;
  try {
    truth =
        sampling::answers_of(judge, subject.names, parts, static_cast<int>(parts.front().x.rows()));
    if (truth.done < kLeastDone)
      throw UserError(
          subject.worlds.scene.name,
          fmt::format("{} of {} worlds of the prior do what is asked: too few to measure errors "
                      "against",
                      truth.done, truth.samples),
          fmt::format("Raise --budget-s, to about {:.0f}.",
                      std::ceil(words.budget() * kLeastDone * 1.5 / std::max(1, truth.done))));
    const int steps = worlds_for((1.0 - kForTheTruth) * words.budget() /
                                 static_cast<double>(ways.size() * kChains));
    for (Trial& way : ways) run_trial(way, subject, steps, truth);
    ways.push_back(brute_force(judge, subject, drawn, truth));
  } catch (const NotImplemented& stub) {
    context.exit = ExitCode::kNotAttempted;
    fmt::print("{}\n", stub.what());
    return;
  }
  const double floor = 1.0 / std::sqrt(static_cast<double>(truth.done));

  // The same on stdout and on the page.
  const std::string title =
      fmt::format("{} ({}) on: {}", kind.id, word, subject.worlds.scene.title);
  const std::vector<std::string> readings = readings_of(ways, truth);
  const report::Table table = table_of(ways);
  report::Page page("What accuracy costs", title);
  for (const std::string& reading : readings) page.paragraph(reading);
  page.plot(plot_of(ways, floor));
  page.table(table);
  page.heading("How it was measured");
  page.paragraph(subject.worlds.scene.about);
  page.paragraph(fmt::format(
      "Errors are against the means of {} worlds that do what is asked, of {} drawn from the "
      "prior: known to {:.2g} deviations. The error is that of one chain: the root of the mean "
      "square over {} chains, each from a start of its own with {:.0f} % of its steps as a "
      "warm-up, "
      "and over the {} numbers in which worlds differ, each in multiples of its deviation. It "
      "counts what a chain claims for nothing.",
      truth.done, truth.samples, floor, kChains, 100.0 * kWarmUp, subject.names.size()));
  page.paragraph(
      "Plain: all proposals take the scene's steps. Mixed: a share of them takes wide steps, as "
      "the scene says. Tempered: near misses are probable. Hard: all or nothing. CPU time is that "
      "of one chain with its warm-up, on this machine, in this run: only ratios matter.");
  if (word != "student" && word != "reference")
    page.paragraph(
        "This module runs in the sandbox, where each call costs some microseconds more, little "
        "beside a simulation.",
        report::Look::kMuted);
  page.record(record_of(context, subject.worlds.scene));
  const std::filesystem::path file = std::filesystem::path(words.out) / words.name() / "index.html";
  page.write(file);
  if (words.json)
    return print_json(context, {{"title", title},
                                {"readings", readings},
                                {"truth_done", truth.done},
                                {"truth_samples", truth.samples},
                                {"floor", floor},
                                {"ways", json_of(ways)},
                                {"page", file.string()}});
  fmt::print("{}\n", title);
  print_table(table);
  for (const std::string& reading : readings) fmt::print("{}\n", reading);
  fmt::print("{}\n", file.string());
}

}  // namespace tumble::cli
