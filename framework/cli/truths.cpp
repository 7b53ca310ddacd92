// tumble truths FOLDER: what this project computes, against reference values computed elsewhere at high precision.
#include <cstdio>
#include <map>
#include <memory>

#include <nlohmann/json.hpp>

#include "framework/cli/read_truth.h"
#include "framework/cli/verb.h"
#include "framework/core/not_implemented.h"
#include "framework/engines/truths/families.h"
#include "framework/modules/load.h"

namespace tumble::cli {
namespace {

using truths::Case;
using truths::Comparison;
using truths::Line;
using truths::Verdict;

struct Options {
  std::filesystem::path folder;
  std::string modules = "reference";
  bool each = false;
  bool json = false;
};

/// The modules chosen, as tables and as laws.
struct Chosen {
  std::map<std::string, modules::AnyModule> tables;  // by id
  Laws laws = library_laws();
};

struct CaseResult {
  std::string id;
  std::vector<Line> lines;
};

/// `student` and `reference` stand for the shared objects of the build tree, anything else is a path: of one shared object,
/// or of a folder that holds ID.so. A path gives the modules it holds; the others are the reference's, else the student's.
Chosen load_modules(const Context& context, const std::string& which) {
  namespace fs = std::filesystem;
  Chosen chosen;
  const bool named = which == "student" || which == "reference";
  bool any_loaded = false;
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const auto built = [&](const std::string& name) { return context.build / "modules" / (kind->id + "_" + name + ".so"); };
    modules::AnyModule table;
    if (named) {
      table = modules::load_module(*kind, built(which));
    } else if (fs::is_directory(which)) {
      if (fs::exists(fs::path(which) / (kind->id + ".so"))) table = modules::load_module(*kind, fs::path(which) / (kind->id + ".so"));
    } else {
      try {
        table = modules::load_module(*kind, which);
      } catch (const UserError&) {
        if (!fs::exists(which)) throw;  // a shared object of another module: tried with the next kind
      }
    }
    any_loaded = any_loaded || table != nullptr;
    if (table == nullptr) table = modules::load_module(*kind, fs::exists(built("reference")) ? built("reference") : built("student"));
    kind->bind(table, chosen.laws);
    chosen.tables[kind->id] = table;
  }
  if (!any_loaded)
    throw UserError("--modules " + which, "holds no module of any assignment", "Give student, reference, or a shared object built from a file that implements a module's header.");
  return chosen;
}

/// Everything that is known about a case; nothing when its family is not.
std::optional<CaseResult> compute(const Context& context, const Chosen& chosen, const Case& truth) {
  Comparison comparison;
  bool known = false;
  if (const auto family = truths::framework_families().find(truth.family); family != truths::framework_families().end()) {
    comparison.attempt(truth.family, [&] { family->second(truth, chosen.laws, comparison); });
    known = true;
  }
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const auto family = kind->truth_families.find(truth.family);
    if (family == kind->truth_families.end()) continue;
    comparison.attempt(truth.family, [&] { family->second(chosen.tables.at(kind->id), truth, comparison); });
    known = true;
  }
  if (!known) return std::nullopt;
  return CaseResult{truth.id, comparison.lines()};
}

// ---- Printing --------------------------------------------------------------------------------------------------------

std::string show(double x) {
  if (std::isnan(x)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, x == 0.0 ? "0" : "%.2e", x);
  return text;
}

void print_line(const std::string& name, const std::string& output, const Line& line, Verdict verdict) {
  std::printf("%-46s %-38s %10s %10s %10s  %s\n", name.c_str(), output.c_str(), show(line.error).c_str(), show(line.floor).c_str(),
              show(line.pass_mark).c_str(), truths::word_of(verdict).c_str());
}

void print_case(const CaseResult& result, bool each) {
  const Line* worst = truths::worst_line(result.lines);
  if (worst == nullptr) return;
  const Verdict verdict = truths::verdict_of(result.lines);
  print_line(result.id, worst->output, *worst, verdict);
  for (const Line& line : result.lines) {
    const bool bad = line.verdict == Verdict::kWrong || line.verdict == Verdict::kNotAttempted;
    if (!each && !bad) continue;
    print_line("", line.output, line, line.verdict);
    if (!line.note.empty()) std::printf("%-46s   %s\n", "", line.note.c_str());
  }
}

nlohmann::ordered_json to_json(const CaseResult& result) {
  const auto number = [](double x) { return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr); };
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const Line& line : result.lines) {
    lines.push_back({{"output", line.output}, {"error", number(line.error)}, {"floor", number(line.floor)}, {"pass_mark", number(line.pass_mark)},
                     {"verdict", truths::word_of(line.verdict)}, {"note", line.note}});
  }
  return {{"id", result.id}, {"verdict", truths::word_of(truths::verdict_of(result.lines))}, {"outputs", lines}};
}

/// How many cases have each verdict, in the order of the enumeration; and how many outputs were compared.
struct Count {
  std::map<Verdict, int> cases;
  int outputs = 0;
};

Count count(const std::vector<CaseResult>& results) {
  Count count;
  for (const CaseResult& result : results) {
    ++count.cases[truths::verdict_of(result.lines)];
    for (const Line& line : result.lines) count.outputs += line.verdict == Verdict::kRight || line.verdict == Verdict::kWrong;
  }
  return count;
}

void print_summary(const std::vector<CaseResult>& results, const std::map<std::string, int>& skipped) {
  Count counted = count(results);
  std::printf("\n%zu cases, %d outputs compared: %d right, %d wrong, %d not attempted", results.size(), counted.outputs,
              counted.cases[Verdict::kRight], counted.cases[Verdict::kWrong], counted.cases[Verdict::kNotAttempted]);
  if (counted.cases[Verdict::kNotCompared] > 0) std::printf(", %d not compared", counted.cases[Verdict::kNotCompared]);
  std::printf("\n");
  int cases = 0;
  std::string families;
  for (const auto& [family, n] : skipped) {
    cases += n;
    families += (families.empty() ? "" : ", ") + family + " (" + std::to_string(n) + ")";
  }
  if (cases > 0) std::printf("skipped %d cases of %zu families that are not known here: %s\n", cases, skipped.size(), families.c_str());
}

ExitCode exit_code(const std::vector<CaseResult>& results) {
  Count counted = count(results);
  if (counted.cases[Verdict::kWrong] > 0) return ExitCode::kCheckFailed;
  return counted.cases[Verdict::kNotAttempted] > 0 ? ExitCode::kNotAttempted : ExitCode::kFine;
}

ExitCode run_truths(const Context& context, const Options& options) {
  const Chosen chosen = load_modules(context, options.modules);
  std::vector<CaseResult> results;
  std::map<std::string, int> skipped;
  if (!options.json) std::printf("%-46s %-38s %10s %10s %10s  %s\n", "case", "output closest to its mark", "error", "floor", "pass mark", "verdict");
  for (const auto& file : find_truths(options.folder)) {
    const Case truth = read_truth(file);
    const std::optional<CaseResult> result = compute(context, chosen, truth);
    if (!result) {
      ++skipped[truth.family];
      continue;
    }
    results.push_back(*result);
    if (!options.json) print_case(*result, options.each), std::fflush(stdout);
  }
  if (options.json) {
    nlohmann::ordered_json all{{"command", context.command_line}, {"modules", options.modules}, {"cases", nlohmann::ordered_json::array()}, {"skipped", skipped}};
    for (const CaseResult& result : results) all["cases"].push_back(to_json(result));
    std::printf("%s\n", all.dump(1).c_str());
  } else {
    print_summary(results, skipped);
  }
  return exit_code(results);
}

}  // namespace

void add_truths(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("truths", "Compare what is computed here with reference values of high precision");
  verb->add_option("folder", options->folder, "Folder of truth files, or one file (tests/truths)")->required();
  verb->add_option("--modules", options->modules, "student, reference, a shared object, or a folder with ID.so")->capture_default_str();
  verb->add_flag("--each", options->each, "Show every output, not only the one closest to its mark");
  verb->add_flag("--json", options->json, "The same for machines");
  verb->callback([&context, options] { context.exit = run_truths(context, *options); });
}

}  // namespace tumble::cli
