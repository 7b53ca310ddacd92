// tumble battery: the cases that are known to break simulations, against thresholds derived
// beforehand, on one page.
#include "framework/cli/battery.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/json_output.h"
#include "framework/cli/kept_at_stop.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/read_truth.h"
#include "framework/cli/record.h"
#include "framework/cli/verb.h"
#include "framework/core/text.h"
#include "framework/modules/bind_laws.h"
#include "framework/report/battery_page.h"
#include "framework/report/tables_json.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using report::BatteryRow;
using report::Measure;
using report::Outcome;

struct BatteryOptions {
  bool is_long = false, each = false, json = false;
  std::vector<std::string> only;
  std::string out = "out", modules;
};

bool is_wanted(const battery::Case& a_case, const std::vector<std::string>& only) {
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& word) {
           return word == std::to_string(a_case.row) ||
                  (!std::isdigit(static_cast<unsigned char>(word[0])) &&
                   lowercase(a_case.name).find(lowercase(word)) != std::string::npos);
         });
}

/// Adds laws and modules: by the given word, else the reference's where this tree has one, else the
/// student's.
void provide(const Context& context, const std::string& word, battery::Given& given) {
  given.laws = library_laws();
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const bool has_reference = fs::exists(context.build / "modules" / (kind->id + "_reference.so"));
    const std::string chosen = !word.empty() ? word : has_reference ? "reference" : "student";
    const modules::AnyModule module = load_word(context, *kind, chosen);
    given.modules[kind->id] = module;
    modules::bind_laws(*kind, module, kind->id + ' ' + chosen, given.laws);
  }
}

// Names are cut in the middle, which carries the least information.
void print_measure(const std::string& name, const Measure& m) {
  fmt::print("{:<24} {:<50} {:>15} {:>15} {:>9}  {}\n", without_middle(name, 24),
             without_middle(m.what, 50), report::shown_value(m), report::shown_threshold(m),
             report::shown_margin(m), report::word_of(report::outcome_of(m)));
  const std::string note = !m.error.empty()                           ? m.error
                           : !m.not_run.empty()                       ? m.not_run
                           : report::outcome_of(m) == Outcome::kShort ? m.shortfall
                                                                      : "";
  if (!note.empty()) fmt::print("{:<24}   {}\n", "", note);
}

// One line per case, and one for every failure; methods that must fail are always shown.
void print_row(const BatteryRow& row, bool each) {
  const std::string name = fmt::format("{:>2} {}", row.row, row.name);
  const Measure* worst = report::tightest(row);
  if (worst == nullptr) {
    fmt::print("{:<24} not part of the battery yet: {}\n", without_middle(name, 24), row.not_part);
  } else {
    print_measure(name, *worst);
    for (const Measure& m : row.measures)
      if (&m != worst && (each || report::outcome_of(m) != Outcome::kHolds)) print_measure("", m);
  }
  std::fflush(stdout);
}

void run_battery(Context& context, const BatteryOptions& options) {
  const fs::path truths = context.root / "tests" / "truths";
  battery::Given given;
  provide(context, options.modules, given);
  given.is_long = options.is_long;
  if (options.is_long)
    given.on_measure = [](const Measure& m) {
      fmt::print(stderr, "tumble:    {}: {}\n", m.what,
                 !m.error.empty()     ? m.error
                 : !m.not_run.empty() ? m.not_run
                                      : report::shown_value(m));
    };
  given.truth = [truths](const std::string& id) {
    std::string name = id;
    if (const auto slash = name.find('/'); slash != std::string::npos) name.replace(slash, 1, "__");
    return read_truth(truths / (name + ".json"));
  };
  std::vector<battery::Case> wanted;
  for (const battery::Case& a_case : battery::cases())
    if (is_wanted(a_case, options.only)) wanted.push_back(a_case);
  if (wanted.empty())
    throw UserError("--only", "no case has that number or that word in its name",
                    "Run without --only to see all of them.");
  std::vector<BatteryRow> rows;
  if (!options.json)
    fmt::print("{:<24} {:<50} {:>15} {:>15} {:>9}  {}\n", "case",
               "closest to its threshold; methods that must fail", "value", "threshold", "margin",
               "verdict");
  const fs::path page = fs::path(options.out) / "battery.html";
  const std::string subtitle =
      std::string(options.is_long ? "long runs" : "short runs (--long: the whole lengths)") +
      "; integration: " + given.laws.integrator_source +
      ", impulses: " + given.laws.impulse_source + ", constraints: " + given.laws.constraint_source;
  KeptAtStop stop("cases");
  for (const battery::Case& a_case : wanted) {
    fmt::print(stderr, "tumble: {} {}\n", a_case.row, a_case.name);
    rows.push_back(battery::run(a_case, given));
    if (!options.json) print_row(rows.back(), options.each);
    const std::string so_far =
        rows.size() == wanted.size()
            ? ""
            : fmt::format("; {} of {} cases so far", rows.size(), wanted.size());
    stop.keep(rows.size(), wanted.size(), page.string(), [&] {
      report::write_battery_page(rows, subtitle + so_far, record_of(context), page);
    });
  }
  const report::BatteryCount count = report::count_of(rows);
  if (options.json)
    print_json(context, {{"is_long", options.is_long},
                         {"summary", report::sentence_of(count)},
                         {"rows", report::json_of(rows)},
                         {"page", page.string()}});
  else
    fmt::print("\n{}\n{}\n", report::sentence_of(count), page.string());
  if (!count.good()) context.exit = ExitCode::kCheckFailed;
}

}  // namespace

void add_battery(CLI::App& app, Context& context) {
  auto options = std::make_shared<BatteryOptions>();
  Verb verb(
      app, "battery",
      "Run the cases that are known to break simulations, against thresholds derived beforehand");
  verb.flag("--long", options->is_long,
            "Whole lengths: stacks of 60 s, a million steps, an hour of timewarp (half an hour, "
            "most of it houses of cards that fall)");
  verb.option("--only", options->only, "Cases by number, or by a word of the name");
  verb.flag("--each", options->each,
            "Show every measure, not only the one closest to its threshold");
  verb.option("--out", options->out, "Folder of the page battery.html").shows_default();
  verb.option("--modules", options->modules, "student, reference, PATH.cpp or PATH.so")
      .default_text("reference where this tree has one, else student");
  verb.flag("--json", options->json, "For machines");
  verb.runs([&context, options] { run_battery(context, *options); });
}

}  // namespace tumble::cli
