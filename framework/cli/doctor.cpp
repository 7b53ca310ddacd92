// tumble doctor: what this machine has for grading, what follows, and how to mend what is missing.
#include <cstdio>
#include <memory>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/verb.h"
#include "framework/core/terminal.h"
#include "framework/core/version.h"
#include "framework/grading/course/machine.h"
#include "framework/grading/sandbox/protection.h"

namespace tumble::cli {
namespace {

using Json = nlohmann::ordered_json;
using State = grading::Finding::State;

const char* words_of(State state) {
  switch (state) {
    case State::kGood: return "ok";
    case State::kNote: return "note";
    case State::kMissing: break;
  }
  return "missing";
}

std::string painted(State state) {
  const std::string text = fmt::format("{:<8}", words_of(state));
  if (!shows_colours(STDOUT_FILENO)) return text;
  return fmt::format("\033[{}m{}\033[0m",
                     state == State::kGood   ? "32"
                     : state == State::kNote ? "33"
                                             : "1;31",
                     text);
}

void print_text(const grading::MachineReport& report) {
  for (const auto& finding : report.findings) {
    fmt::print("{} {:<20} {}\n", painted(finding.state), finding.what, finding.found);
    if (!finding.remedy.empty()) fmt::print("{:29} -> {}\n", "", finding.remedy);
  }
  fmt::print("\nSandboxes, the strongest first:\n");
  for (const auto& found : report.sandboxes) {
    const bool is_chosen = report.chosen == found.traits.kind;
    fmt::print("\n  {}{}: {}{}\n", found.traits.name, is_chosen ? " (used here)" : "",
               found.why_not ? "does not work here: " + *found.why_not : "works here",
               found.traits.is_official ? "" : "; not for official grades");
    fmt::print("    a submission cannot  {}\n    it still can         {}\n", found.traits.withholds,
               found.traits.permits);
  }
  fmt::print("\n{}\n", report.allows_official_grades()
                           ? "Official grades can be made here."
                           : "Official grades cannot be made here: mend what is missing above.");
}

Json to_json(const Context& context, const grading::MachineReport& report) {
  Json json{{"command", context.command_line},
            {"version", kProgramVersion},
            {"official_grades", report.allows_official_grades()},
            {"sandbox", nullptr},
            {"sandboxes", Json::array()},
            {"findings", Json::array()}};
  if (report.chosen)
    json["sandbox"] = {{"kind", grading::traits_of(*report.chosen).name},
                       {"protection", grading::protection_in_words(*report.chosen)}};
  for (const auto& found : report.sandboxes)
    json["sandboxes"].push_back({{"kind", found.traits.name},
                                 {"works", !found.why_not},
                                 {"why_not", found.why_not.value_or("")},
                                 {"official", found.traits.is_official},
                                 {"withholds", found.traits.withholds},
                                 {"permits", found.traits.permits}});
  for (const auto& finding : report.findings)
    json["findings"].push_back({{"what", finding.what},
                                {"state", words_of(finding.state)},
                                {"found", finding.found},
                                {"remedy", finding.remedy}});
  return json;
}

}  // namespace

void add_doctor(CLI::App& app, Context& context) {
  auto json = std::make_shared<bool>(false);
  Verb verb(app, "doctor",
            "What this machine has for grading: sandbox, compiler, packages, room; and how to mend "
            "what is missing");
  verb.flag("--json", *json, "The same for machines");
  verb.footer(
      "TUMBLE_SANDBOX=namespaces, landlock or bare examines that kind in place of the strongest "
      "that works.\nExit: 0 official grades can be made here, 1 they cannot.");
  verb.runs([&context, json] {
    const grading::MachineReport report = grading::examine_machine(context.root, context.build);
    if (*json)
      fmt::print("{}\n",
                 to_json(context, report).dump(1, ' ', false, Json::error_handler_t::replace));
    else
      print_text(report);
    context.exit = report.allows_official_grades() ? ExitCode::kFine : ExitCode::kCheckFailed;
  });
}

}  // namespace tumble::cli
