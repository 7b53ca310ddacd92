// The list of verbs, in the order of help.
#include "framework/cli/help_format.h"
#include "framework/cli/verb.h"

namespace tumble::cli {

void add_verbs(CLI::App& app, Context& context) {
  begin_group(app, "for students");
  add_check(app, context);
  add_watch(app, context);
  add_start(app, context);
  add_scenes(app, context);
  add_sample(app, context);
  add_run(app, context);
  add_poke(app, context);
  add_live(app, context);
  add_explain(app, context);
  add_inspect(app, context);
  begin_group(app, "what accuracy costs");
  add_cost(app, context);
  add_engines(app, context);
  add_sweep(app, context);
  add_plots(app, context);
  add_truths(app, context);
  add_battery(app, context);
  begin_group(app, "for teaching assistants");
  add_demo(app, context);
  add_grade(app, context);
  add_regrade(app, context);
  add_class(app, context);
  add_ledger(app, context);
  add_doctor(app, context);
  begin_group(app, "for instructors");
  add_new(app, context);
  add_handouts(app, context);
  add_audit(app, context);
  add_attack(app, context);
  add_release(app, context);
  add_package(app, context);
  add_export(app, context);
  add_autograde(app, context);
}

}  // namespace tumble::cli
