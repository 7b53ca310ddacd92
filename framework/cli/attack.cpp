// tumble attack [NAME...]: does the grader withstand hostile submissions?
#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/json_output.h"
#include "framework/cli/verb.h"
#include "framework/core/nearest_word.h"
#include "framework/grading/attacks/run_attacks.h"
#include "framework/grading/sandbox/protection.h"

namespace tumble::cli {
namespace {

using grading::Attack;
using grading::AttackReport;
using grading::AttackResult;

struct AttackWords {
  std::vector<std::string> names;
  bool all = false, json = false, list = false;
  std::string body;
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

std::vector<Attack> chosen(std::vector<Attack> all, const AttackWords& words) {
  std::vector<std::string> known;
  for (const Attack& attack : all) known.push_back(attack.name);
  for (const std::string& name : words.names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw UserError(name, "is no attack of solutions_private/attacks",
                      "tumble attack --list prints them." + did_you_mean(name, known));
  std::erase_if(all, [&](const Attack& attack) {
    if (words.names.empty()) return !words.all && !words.list && !attack.is_sample;
    return std::find(words.names.begin(), words.names.end(), attack.name) == words.names.end();
  });
  return all;
}

// The kinds that protect grades and work here, or the one that was asked for.
std::vector<std::string> bodies(const std::string& asked) {
  std::vector<std::string> names;
  for (const grading::SandboxTraits& traits : grading::all_sandboxes()) {
    if (asked.empty() ? !traits.is_official : asked != traits.name) continue;
    const auto why_not = grading::why_no_sandbox(traits.kind);
    if (!why_not)
      names.push_back(traits.name);
    else
      fmt::print(stderr, "not tried, because it does not work on this machine: {} ({})\n",
                 traits.name, *why_not);
  }
  if (!asked.empty()) grading::sandbox_from_name(asked);
  if (names.empty())
    throw UserError(asked.empty() ? "sandbox" : asked, "none works on this machine",
                    "tumble doctor says why.");
  return names;
}

void print_list(const std::vector<Attack>& attacks) {
  for (const Attack& attack : attacks)
    fmt::print("{:<34} {:<3} {:<20} {}{}\n", attack.name, attack.module, attack.kind, attack.about,
               attack.is_sample ? " (sample)" : "");
  fmt::print("{} attacks\n", attacks.size());
}

void print_report(const AttackReport& report) {
  for (const AttackResult& r : report.attacks) {
    fmt::print("{:<34} {:<10}  {:>5.1f} s  {:>6g}  {}\n", r.attack, r.sandbox, r.seconds, r.score,
               r.found);
    for (const std::string& fault : r.faults) fmt::print("    FAULT: {}\n", fault);
  }
  for (const std::string& fault : report.faults) fmt::print("FAULT: {}\n", fault);
}

void print_json(const AttackReport& report) {
  auto rows = nlohmann::ordered_json::array();
  for (const AttackResult& r : report.attacks)
    rows.push_back({{"attack", r.attack},
                    {"sandbox", r.sandbox},
                    {"found", r.found},
                    {"score", r.score},
                    {"seconds", r.seconds},
                    {"faults", r.faults}});
  fmt::print("{}\n", json_text({{"attacks", rows}, {"faults", report.faults}}, 2));
}

void attack(Context& context, const AttackWords& words) {
  const auto attacks =
      chosen(grading::read_attacks(context.root / "solutions_private/attacks"), words);
  if (words.list) return print_list(attacks);
  grading::AttackOptions options;
  options.root = context.root;
  options.build = context.build;
  options.jobs = words.jobs;
  options.progress = [](const std::string& sentence) { fmt::print(stderr, "{}\n", sentence); };
  AttackReport report;
  for (const std::string& body : bodies(words.body)) {
    options.sandbox = body;
    AttackReport more = grading::run_attacks(attacks, options);
    std::move(more.attacks.begin(), more.attacks.end(), std::back_inserter(report.attacks));
    std::move(more.faults.begin(), more.faults.end(), std::back_inserter(report.faults));
  }
  const auto withstood = std::count_if(report.attacks.begin(), report.attacks.end(),
                                       [](const AttackResult& r) { return r.faults.empty(); });
  if (words.json) {
    print_json(report);
  } else {
    print_report(report);
    fmt::print("\n{} of {} attacks withstood{}\n", withstood, report.attacks.size(),
               report.faults.empty() ? "; nothing was left, read or disturbed" : "");
  }
  context.exit = report.is_good() ? ExitCode::kFine : ExitCode::kCheckFailed;
}

}  // namespace

void add_attack(CLI::App& app, Context& context) {
  auto words = std::make_shared<AttackWords>();
  Verb verb(app, "attack", "Grade hostile submissions: none may gain, read, leave or disturb");
  verb.option("names", words->names, "Which of solutions_private/attacks; default: a quick sample")
      .type_name("NAME");
  verb.flag("--all", words->all, "All of them: minutes");
  verb.flag("--list", words->list, "Print what there is, and grade nothing");
  verb.option("--body", words->body,
              "namespaces, landlock or bare; default: each that the policy accepts for grades and "
              "that works here")
      .type_name("KIND");
  verb.option("--jobs", words->jobs, "Submissions at a time")
      .between(1, 256)
      .default_text("number of cores");
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Each is graded as a student would hand it in, with an honest right solution beside it. A "
      "fault is: a verdict that the attack's head does not name, a point more than "
      "a harmless submission has, another result of the honest one, a secret in an output, a "
      "process or a file that is left, a grader that ends.\n"
      "Exit: 0 all withstood, 1 otherwise.");
  verb.runs([&context, words] { attack(context, *words); });
}

}  // namespace tumble::cli
