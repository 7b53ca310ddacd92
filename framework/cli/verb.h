/// The command line: one file per verb. A verb's `add_` function declares its words and the
/// function that it runs.
#pragma once

#include "framework/cli/command.h"
#include "framework/cli/words.h"
#include "framework/modules/registry.h"

namespace tumble::cli {

/// Data that most verbs receive.
struct Context : Command {
  modules::Registry registry;
};

// stdout is the result (--json for machines), stderr is talk and progress.
/// Declares every verb (verbs.cpp).
void add_verbs(CLI::App& app, Context& context);

void add_attack(CLI::App& app, Context& context);
void add_audit(CLI::App& app, Context& context);
void add_autograde(CLI::App& app, Context& context);
void add_battery(CLI::App& app, Context& context);
void add_class(CLI::App& app, Context& context);
void add_cost(CLI::App& app, Context& context);
void add_demo(CLI::App& app, Context& context);
void add_doctor(CLI::App& app, Context& context);
void add_engines(CLI::App& app, Context& context);
void add_explain(CLI::App& app, Context& context);
void add_export(CLI::App& app, Context& context);
void add_grade(CLI::App& app, Context& context);
void add_ledger(CLI::App& app, Context& context);
void add_package(CLI::App& app, Context& context);
void add_live(CLI::App& app, Context& context);
void add_poke(CLI::App& app, Context& context);
void add_regrade(CLI::App& app, Context& context);
void add_release(CLI::App& app, Context& context);
void add_run(CLI::App& app, Context& context);
void add_sample(CLI::App& app, Context& context);
void add_scenes(CLI::App& app, Context& context);
void add_sweep(CLI::App& app, Context& context);
void add_truths(CLI::App& app, Context& context);

}  // namespace tumble::cli
