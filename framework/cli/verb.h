/// The command line: one file a verb. A verb's `add_` function declares its words and what runs when they are given.
#pragma once

#include <filesystem>
#include <string>

#include "framework/cli/words.h"
#include "framework/core/error.h"
#include "framework/modules/registry.h"

namespace tumble::cli {

/// What every verb is given.
struct Context {
  std::filesystem::path root;       // of the source tree
  std::filesystem::path build;      // of the build tree that this program is from
  std::string command_line;         // as typed, for records
  modules::Registry registry;
  ExitCode exit = ExitCode::kFine;  // what the verb that ran says
};

// stdout is the result (--json for machines), stderr is talk and progress.
/// Declares every verb (verbs.cpp).
void add_verbs(CLI::App& app, Context& context);

void add_audit(CLI::App& app, Context& context);
void add_battery(CLI::App& app, Context& context);
void add_check(CLI::App& app, Context& context);
void add_cost(CLI::App& app, Context& context);
void add_demo(CLI::App& app, Context& context);
void add_doctor(CLI::App& app, Context& context);
void add_engines(CLI::App& app, Context& context);
void add_explain(CLI::App& app, Context& context);
void add_grade(CLI::App& app, Context& context);
void add_handouts(CLI::App& app, Context& context);
void add_inspect(CLI::App& app, Context& context);
void add_plots(CLI::App& app, Context& context);
void add_poke(CLI::App& app, Context& context);
void add_release(CLI::App& app, Context& context);
void add_run(CLI::App& app, Context& context);
void add_truths(CLI::App& app, Context& context);
void add_watch(CLI::App& app, Context& context);

}  // namespace tumble::cli
