#include "framework/cli/planned_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/cost_measure.h"
#include "framework/cli/cost_methods.h"
#include "framework/core/cpu_time.h"
#include "framework/core/nearest_word.h"
#include "framework/core/text.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/report/cost_page.h"
#include "framework/scene/words.h"

namespace tumble::cli {
namespace {

using cost::CostChoice;
using cost::CostMethod;
using cost::CostReference;

constexpr double kMostSearch = 40.0;         // s of CPU, of a search for an error
constexpr double kSearchOverBudget = 4.0;    // of a search for a time: in multiples of that time
constexpr double kLeastPlannedSearch = 5.0;  // s
constexpr double kFrameRate = 60.0;          // Hz: as RunOptions records

std::string asked_of(const RunWords& words) {
  return words.accuracy_m ? fmt::format("--accuracy {:g}", *words.accuracy_m)
                          : fmt::format("--budget-s {:g}", *words.budget_s);
}

/// Whether the motion's module was chosen by name: then the run uses it.
bool motion_is_named(const Context& context, const ChosenLaws& chosen, const RunWords& words) {
  for (const auto& [id, word] : parse_module_words(words.modules, context.registry))
    if (!id.empty() && word != "library" && chosen.laws.integrator_source.starts_with(id + ' '))
      return true;
  return false;
}

/// Methods in the expected order of their cost, so that the others need little time.
std::vector<CostMethod> methods_for(const Context& context, const scene::Scene& scene,
                                    const ChosenLaws& chosen, const RunWords& words) {
  std::vector<CostMethod> methods;
  if (motion_is_named(context, chosen, words)) {
    CostMethod own;
    own.name = chosen.laws.integrator_source;
    own.laws = chosen.laws;
    return {own};
  }
  if (cost::goes_in_closed_form(scene))
    for (const char* word : {"ca", "tw", "auto"})
      if (std::string(word) != "tw" || engines::fast_timewarp())
        methods.push_back(method_by_engine(word, chosen.laws, true));
  if (words.budget_s) {  // the most accurate first
    for (const char* word : {"fehlberg78", "bulirsch-stoer", "dopri5", "rk4"})
      methods.push_back(method_by_integrator(method_named(word), chosen.laws));
  } else {
    for (const char* word : {"dopri5", "rk4", "fehlberg78", "bulirsch-stoer"})
      methods.push_back(method_by_integrator(method_named(word), chosen.laws));
  }
  if (scene::asks_for(scene, [](const scene::Traits& traits) { return traits.may_be_stiff; }))
    methods.push_back(method_by_integrator(method_named("rosenbrock4"), chosen.laws));
  for (const char* word : {"midpoint", "verlet", "symplectic"})
    methods.push_back(method_by_integrator(method_named(word), chosen.laws));
  return methods;
}

std::string fineness_of(const CostChoice& choice) {
  if (!choice.method.has_refinement) return "closed form, no step";
  const std::string step = fmt::format("steps of {} s", step_in_words(choice.result.step_s));
  return choice.method.controlled
             ? fmt::format("tolerance {}, within {}", few_digits(choice.tolerance), step)
             : step;
}

std::string price_of(const CostChoice& choice) { return report::price_of(choice.result.cpu_s); }

/// The flags that repeat the run without a search.
std::string flags_of(const CostChoice& choice) {
  if (choice.method.engine != "rd") return "--engine " + choice.method.engine;
  const std::string step = fmt::format("--step-s {:.17g}", choice.result.step_s);
  if (choice.method.propagator == "auto") return "--propagator auto " + step;
  if (!choice.method.step_function) return step;
  return fmt::format(
      "--method {} {}{}", choice.method.word,
      choice.method.controlled ? fmt::format("--tolerance {:.3g} ", choice.tolerance) : "", step);
}

[[noreturn]] void refuse(const RunWords& words, const cost::CostChoices& found,
                         const CostReference& reference) {
  if (!found.closest)
    throw UserError(asked_of(words), "no method completes a run of this scene",
                    "Run it without the flag to see what stops it, or see tumble cost.");
  const std::string name = found.closest->method.name + ", " + fineness_of(*found.closest);
  if (words.budget_s)
    throw UserError(
        asked_of(words),
        fmt::format("the cheapest run of this scene takes {} ({})", price_of(*found.closest), name),
        "Give it that, or a shorter --duration-s.");
  throw UserError(
      asked_of(words),
      fmt::format("no method reaches it{}: the closest is {} m by {}, for {}; the reference "
                  "solution is known to {} m",
                  found.was_cut_short ? fmt::format(" in a search of {:.0f} s", kMostSearch) : "",
                  few_digits(found.closest->result.error_m), name, price_of(*found.closest),
                  few_digits(reference.floor_m)),
      fmt::format("Request {}, or less time with --duration-s.",
                  few_digits(found.closest->result.error_m)));
}

/// Errors below the floor of the reference solution are reported as that floor.
std::string told_error(double error, const PlannedRun::Search& search) {
  return error <= search.reference.floor_m ? "the error floor of the reference solution"
                                           : fmt::format("an error of {} m", few_digits(error));
}

std::string choice_in_words(const PlannedRun::Search& search) {
  const CostChoice& choice = search.choice;
  return fmt::format("{}, {}: expected are {} and {} of CPU time", choice.method.name,
                     fineness_of(choice), told_error(choice.result.error_m, search),
                     price_of(choice));
}

PlannedRun::Search look(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                        const RunWords& words) {
  const double begun = cpu_seconds();
  PlannedRun::Search search;
  search.goal = {words.accuracy_m, words.budget_s};
  cost::CostOptions options;
  options.timewarp = engines::fast_timewarp();
  options.duration_s = words.duration_s;
  options.frame_rate_hz = kFrameRate;
  options.shorten = false;
  options.progress = [](const std::string& what) { fmt::print(stderr, "tumble: {}\n", what); };
  search.reference = cost::find_reference(scene, chosen.laws, options);
  check_with_files(context, scene, chosen.laws, search.reference);
  if (words.accuracy_m && search.reference.floor_m > *words.accuracy_m)
    throw UserError(asked_of(words),
                    fmt::format("the reference solution is known to {} m only, over {:.3g} s ({})",
                                few_digits(search.reference.floor_m), search.reference.duration_s,
                                search.reference.what),
                    fmt::format("Request {} or more, or less time with --duration-s.",
                                few_digits(2.0 * search.reference.floor_m)));
  const double most = words.accuracy_m
                          ? kMostSearch
                          : std::max(kLeastPlannedSearch, kSearchOverBudget * *words.budget_s),
               until = cpu_seconds() + most;
  const cost::CostChoices found = cost::choose_method(
      scene, methods_for(context, scene, chosen, words), search.reference, search.goal, most,
      options, [&](const CostChoice& trial) {
        const std::string result =
            trial.result.stopped_by.empty()
                ? fmt::format("error {} m, {}", few_digits(trial.result.error_m), price_of(trial))
                : "does not reach the end";
        fmt::print(stderr, "  {:<32} {:<40} {:<28} at most {:.0f} s of search left\n",
                   trial.method.name, fineness_of(trial), result,
                   std::max(0.0, until - cpu_seconds()));
      });
  if (!found.best) refuse(words, found, search.reference);
  search.choice = *found.best;
  search.was_cut_short = found.was_cut_short;
  search.seconds = cpu_seconds() - begun;
  fmt::print(stderr, "tumble: chosen {}\n", choice_in_words(search));  // before the run
  return search;
}

double error_of(const PlannedRun::Search& search, const Trajectory& run) {
  double most = 0.0;
  auto frame = run.frames.begin();  // beside those of the samples there are those of checks
  for (const Frame& sample : search.reference.samples) {
    while (frame != run.frames.end() && frame->time < sample.time - engines::kSameInstant) ++frame;
    if (frame == run.frames.end() || frame->time > sample.time + engines::kSameInstant)
      return std::numeric_limits<double>::quiet_NaN();
    most = std::max(most, cost::distance_between(*frame, sample, search.reference.radii));
  }
  return most;
}

double paid(const PlannedRun::Search& search, double cpu_s) {
  return std::max(1e-6, cpu_s - search.choice.result.building_s);
}

}  // namespace

void add_plan_words(Verb& verb, RunWords& words) {
  verb.option("--accuracy", words.accuracy_m,
              "Choose method and step for an error of at most this [m] in every frame, and say "
              "what it costs")
      .positive()
      .type_name("M");
  verb.option("--budget-s", words.budget_s,
              "Choose method and step for the least error that this much CPU time [s] buys")
      .positive()
      .type_name("S");
  verb.option("--method", words.method,
              "Method of integration in place of the laws' own: euler, symplectic, midpoint, "
              "verlet, rk4, dopri5, fehlberg78, bulirsch-stoer, rosenbrock4, gauss6")
      .type_name("WORD");
  verb.option("--tolerance", words.tolerance, "Of a method that chooses its steps by one")
      .positive();
}

void expect_engine(const std::string& flag, const std::string& word) {
  if (word.empty()) return;
  std::vector<std::string> known;
  for (const auto& [one, meaning] : engines::engine_words()) known.push_back(one);
  if (std::find(known.begin(), known.end(), word) == known.end())
    throw UserError(flag + word, "there is no engine of that name." + did_you_mean(word, known),
                    "Known: " + fmt::format("{}", fmt::join(known, ", ")) + ".");
}

void check_plan_words(const RunWords& words) {
  const std::string asked = words.accuracy_m || words.budget_s ? asked_of(words) : "";
  if (words.accuracy_m && words.budget_s)
    throw UserError(asked + " --budget-s", "an error and a time are both asked for",
                    "Give one: the other follows from it.");
  const bool chosen = words.step_s || !words.engine.empty() || !words.propagator.empty() ||
                      !words.method.empty() || words.tolerance;
  if (!asked.empty() && chosen)
    throw UserError(asked, "it chooses engine, method and step, and one of these is given too",
                    "Leave out --engine, --propagator, --method, --tolerance and --step-s.");
  if (words.method.empty() && words.tolerance)
    throw UserError(fmt::format("--tolerance {:g}", *words.tolerance),
                    "no method is named that has one",
                    "For example --method dopri5 --tolerance 1e-8.");
  if (words.method.empty()) return;
  const Method& method = method_named(words.method);
  if (method.controlled && !words.tolerance)
    throw UserError("--method " + words.method,
                    "it chooses its steps by a tolerance, and none is given",
                    "For example --tolerance 1e-8.");
  if (!method.controlled && words.tolerance)
    throw UserError("--method " + words.method, "it takes the scene's step, and no tolerance",
                    "Leave --tolerance out, or take dopri5.");
}

PlannedRun plan_run(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                    const RunWords& words) {
  check_plan_words(words);
  PlannedRun plan{scene, chosen.laws, {}, std::nullopt};
  // A requested error or time: method and step come from a search.
  if (words.accuracy_m || words.budget_s) {
    plan.search = look(context, scene, chosen, words);
    const CostChoice& choice = plan.search->choice;
    cost::CostOptions options;
    options.timewarp = engines::fast_timewarp();
    cost::CostRun run = cost::run_of(scene, choice.method, plan.search->reference, choice.steps,
                                     choice.tolerance, options);
    plan = {std::move(run.scene), std::move(run.laws), std::move(run.options),
            std::move(plan.search)};
    plan.options.command = context.command_line;
    plan.options.instants_s = engines::instants_of_checks(scene);
    return plan;
  }
  // Otherwise from the flags.
  if (!words.method.empty()) {
    const CostMethod method = method_by_integrator(method_named(words.method), chosen.laws);
    plan.laws = method.laws;
    plan.laws.integrate_step = method.step_function(words.tolerance.value_or(kUnset));
    plan.laws.steps_in_units = method.steps_in_units;
  }
  plan.options.engine = words.engine;
  plan.options.propagator = words.propagator;
  plan.options.timewarp = engines::fast_timewarp();
  plan.options.threads = words.threads;
  plan.options.most_states = words.most_states;
  refuse_threads_of_sandboxes(chosen, words.threads);
  plan.options.step_s = words.step_s;
  plan.options.duration_s = words.duration_s;
  plan.options.command = context.command_line;
  plan.options.instants_s = engines::instants_of_checks(scene);
  return plan;
}

std::string search_in_words(const PlannedRun::Search& search, const Trajectory& run, double cpu_s) {
  const CostChoice& choice = search.choice;
  std::string text = search.goal.error_m
                         ? fmt::format("  asked    an error of at most {:.3g} m in every frame\n",
                                       *search.goal.error_m)
                         : fmt::format("  asked    the least error for {} of CPU time\n",
                                       report::price_of(*search.goal.price_s));
  text += fmt::format("  truth    {}: {} m\n", search.reference.what,
                      few_digits(search.reference.floor_m));
  text += fmt::format("  chosen   {}\n", choice_in_words(search));
  if (search.goal.price_s && choice.result.error_m <= 3.0 * search.reference.floor_m)
    text +=
        "           this is the error floor of the reference solution: more time would show "
        "nothing better\n";
  text +=
      fmt::format("  paid     {} for {}, and {} for models and shapes; the search took {}{}\n",
                  told_error(error_of(search, run), search), report::price_of(paid(search, cpu_s)),
                  report::price_of(choice.result.building_s), report::price_of(search.seconds),
                  search.was_cut_short ? ", after which not all methods had been tried" : "");
  return text + fmt::format("           the same without a search: {}\n", flags_of(choice));
}

nlohmann::ordered_json search_as_json(const PlannedRun::Search& search, const Trajectory& run,
                                      double cpu_s) {
  nlohmann::ordered_json page;
  if (search.goal.error_m) page["asked_error_m"] = *search.goal.error_m;
  if (search.goal.price_s) page["asked_cpu_s"] = *search.goal.price_s;
  page["truth"] = search.reference.what;
  page["truth_error_m"] = search.reference.floor_m;
  page["way"] = search.choice.method.name;
  page["flags"] = flags_of(search.choice);
  page["expected_error_m"] = search.choice.result.error_m;
  page["expected_cpu_s"] = search.choice.result.cpu_s;
  page["error_m"] = error_of(search, run);
  page["cpu_s"] = paid(search, cpu_s);
  page["search_cpu_s"] = search.seconds;
  return page;
}

}  // namespace tumble::cli
