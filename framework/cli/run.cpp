// tumble run SCENE: runs a scene with any mix of modules, judges it by its numbers, and shows it.
#include <memory>

#include "framework/cli/planned_run.h"
#include "framework/cli/scene_run.h"

namespace tumble::cli {

void add_run(CLI::App& app, Context& context) {
  auto words = std::make_shared<RunWords>();
  Verb verb(app, "run", "Run a scene, judge it by its numbers, and show it");
  add_run_words(verb, *words);
  add_plan_words(verb, *words);
  verb.option("--duration-s", words->duration_s, "Simulated time [s] instead of the scene's")
      .positive();
  verb.footer(
      "Example: tumble run t_handle --modules a2=student --sheet t_handle.png\n         tumble run "
      "double_pendulum --accuracy 1e-6\n         tumble run ship.3ds --scale 0.001 --drop --html "
      "ship.html\nExit: 0 every check right, 1 one wrong, 2 something to repair, 4 not attempted.");
  verb.runs([&context, words] {
    const scene::Scene scene = scene_of_words(context, *words, true);
    run_and_tell(context, scene,
                 choose_laws(context, scene, parse_module_words(words->modules, context.registry),
                             words->engine),
                 *words);
  });
}

}  // namespace tumble::cli
