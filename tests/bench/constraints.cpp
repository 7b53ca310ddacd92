// The cost of rods, joints and persistent contacts against the project's goals: one table, by CPU
// time of this machine. Ratios and fractions of real time matter, not seconds.
//   usage: bench_constraints, from the root of the tree
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>

#include "tests/support/places.h"
#include "framework/core/cpu_time.h"
#include "framework/engines/run.h"
#include "framework/scene/load_scene.h"
#include "tests/bench/engine_measures.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

constexpr int kRuns = 3;           // the fastest counts
constexpr double kShortRun = 2.0;  // s: longer runs are not repeated

scene::Scene scene_of_a3(const std::string& name) {
  return scene::load_scene(std::filesystem::path(test::source_dir()) /
                           "assignments/a3_constraints/scenes" / (name + ".json"));
}

struct Price {
  double cpu_s = 0.0, simulated_s = 0.0, steps = 0.0;
};

double cpu_of(const scene::Scene& scene, double duration, Tally& tally) {
  engines::RunOptions options;
  options.duration_s = duration;
  const double begin = cpu_seconds();
  engines::run_scene(scene, reference_laws(), options, tally);
  if (!tally.stopped_by.empty())
    throw std::runtime_error(scene.name + " stopped: " + tally.stopped_by);
  return cpu_seconds() - begin;
}

/// Of the run alone: the set-up of models and laws is measured by a run of one step, and
/// subtracted.
Price price_of(const scene::Scene& scene) {
  Price price{1e300, scene.duration_s, 0.0};
  for (int k = 0; k < kRuns && (k == 0 || price.cpu_s < kShortRun); ++k) {
    Tally whole, one_step;
    const double building = cpu_of(scene, scene.step_s, one_step);
    price.cpu_s = std::min(price.cpu_s, cpu_of(scene, scene.duration_s, whole) - building);
    price.steps = static_cast<double>(whole.counts["steps"] - one_step.counts["steps"]);
  }
  return price;
}

bool tell(const char* what, double found, double goal, const char* unit, const std::string& note) {
  std::printf("%-52s %9.3g %-12s goal: at most %-6g %-6s  %s\n", what, found, unit, goal,
              found <= goal ? "holds" : "MISSED", note.c_str());
  return found <= goal;
}

bool measure_all() {
  bool all_hold = true;
  const auto each_step = [](const std::string& name) {
    const Price price = price_of(scene_of_a3(name));
    return price.cpu_s / price.steps;
  };
  const double hundred = each_step("chain_100"), thousand = each_step("chain_1000");
  all_hold &=
      tell("a step of a chain of 1,000 over one of 100", thousand / hundred, 12.0, "",
           std::to_string(1e6 * hundred) + " and " + std::to_string(1e6 * thousand) + " us");
  scene::Scene stack = scene_of_a3("stack_of_50");
  stack.step_s = 1.0 / 60;
  stack.contact->sleep = false;  // sleeping contacts are not solved
  const Price awake = price_of(stack);
  all_hold &= tell("a stack of 50 at rest, awake, steps of 1/60 s", awake.cpu_s / awake.simulated_s,
                   1.0, "of real time", "");
  const Price bowl = price_of(scene_of_a3("bowl"));
  all_hold &= tell("a bowl of 200 models, 5 s", bowl.cpu_s * 5.0 / bowl.simulated_s, 20.0, "s", "");
  return all_hold;
}

}  // namespace
}  // namespace tumble::testing

int main() try {
  return tumble::testing::measure_all() ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_constraints: %s\n", error.what());
  return 2;
}
