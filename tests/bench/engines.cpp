// The cost of each engine for the same scenes: the words are in kUsage. Without words: all figures
// by which timewarp is judged, in one table with a picture each (engine_figures.cpp), and the parts
// of each engine's time (engine_profiles.cpp). Ratios are of times in this run. rd_auto is rd in
// closed form, as the other two are. With tw2 or tw4 all times of the table are wall times, on an
// otherwise idle machine.
#include <cstdio>
#include <cstdlib>

#include "framework/core/keep_memory.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "tests/bench/engine_figures.h"
#include "tests/bench/engine_measures.h"
#include "tests/support/test_laws.h"

namespace tumble::testing {
namespace {

// With several threads: figures that hardly depend on the load of the machine, CPU time of the
// busiest thread of each epoch and of the sequential parts, in sequence.
void print_critical_path(const Measured& run, double cpu_of_one) {
  if (!run.tally.stages.contains("threads_together")) return;
  const auto spent = [&](const char* stage) {
    return run.tally.stages.at(stage) - run.building.stages.at(stage);
  };
  const double together = spent("threads_together"), alone = spent("thread_alone");
  std::printf(
      "    %.0f rounds; critical path %.3f s of CPU: %.3f together + %.3f alone; one thread's CPU "
      "%.3f s is %.2f of it\n",
      run.count("rounds_of_threads"), together + alone, together, alone, cpu_of_one,
      cpu_of_one / (together + alone));
}

void table(const std::string& scene, int n, const std::vector<std::string>& engines,
           double duration, Clock clock) {
  std::map<std::string, double> seconds;
  double cpu_of_one = kUnset;
  for (const std::string& engine : engines) {
    const Measured run = measure(scene, n, engine, duration, clock);
    seconds[engine] = run.seconds;
    if (engine == "tw") cpu_of_one = run.cpu;
    const double collisions = static_cast<double>(run.tally.collisions);
    std::printf("%-10s %7d %-8s %10.2f %10.2f %10.2f %7.1f%% %9.0f %12.0f %10.3f %12.2f %9.4f\n",
                scene.c_str(), run.bodies, engine.c_str(),
                run.a_body_second(run.count("integrations")),
                run.a_body_second(run.count("pair_checks")), run.a_body_second(collisions),
                100 * run.undone(), run.count("states_kept"), collisions / run.seconds, run.seconds,
                1e6 * run.a_body_second(run.seconds), run.w_h());
    std::printf("    physics %.0f %%: %s (%zu samples)\n", 100 * run.shares.physics,
                engines::in_words(run.shares).c_str(), run.shares.samples);
    print_critical_path(run, cpu_of_one);
    std::fflush(stdout);
  }
  if (!seconds.contains("tw")) return;
  for (const auto& [engine, time] : seconds)
    if (engine != "tw")
      std::printf("%-10s %7d %s/tw %.2f in time\n", scene.c_str(), n, engine.c_str(),
                  time / seconds["tw"]);
}

/// Elastic collisions conserve energy: over a million of them only rounding adds up.
void energy_over_a_million() {
  engines::RunOptions options;
  options.engine = "tw";
  options.timewarp = engines::fast_timewarp();
  options.duration_s = 2800.0;
  options.frame_rate_hz = 0.1;
  Tally tally;
  engines::run_scene(scene::make_sized_scene("gas", 300), test_laws(), options, tally);
  std::printf("gas of 300: %llu collisions, energy off by %.1e of itself at most (allowed 1e-10)\n",
              static_cast<unsigned long long>(tally.collisions), tally.energy_error);
}

constexpr const char* kUsage =
    "bench_engines                       all figures that timewarp is judged by: a table here, a "
    "page in out/bench/engines.html; some four minutes\n"
    "bench_engines --only \"threads\"      one chapter: one body and two, collisions, growth, "
    "late event, threads, the paper's scenes, the heap\n"
    "bench_engines --scene NAME [--n N,N,...] [--engines rd,rd_auto,ca,tw,tw2] [--duration-s T]\n"
    "                                    a row for each size and engine; tw2: on two threads, then "
    "by the clock\n"
    "bench_engines --scene energy        that of a gas over a million elastic collisions\n";

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> found(1);
  for (const char c : text) {
    if (c == ',')
      found.emplace_back();
    else
      found.back() += c;
  }
  return found;
}

}  // namespace
}  // namespace tumble::testing

int main(int argc, char** argv) {
  using namespace tumble::testing;
  tumble::keep_freed_memory();
  std::string scene, only, sizes = "300", engines = "rd,rd_auto,ca,tw";
  double duration = 2.0;
  for (int i = 1; i < argc; i += 2) {
    const std::string flag = argv[i];
    if (flag == "--help" || flag == "-h") return std::fputs(kUsage, stdout), 0;
    if (i + 1 == argc)
      return std::fprintf(stderr, "bench_engines: %s is no flag, or has no value\n%s", argv[i],
                          kUsage),
             2;
    if (flag == "--scene")
      scene = argv[i + 1];
    else if (flag == "--n")
      sizes = argv[i + 1];
    else if (flag == "--engines")
      engines = argv[i + 1];
    else if (flag == "--duration-s")
      duration = std::atof(argv[i + 1]);
    else if (flag == "--only")
      only = argv[i + 1];
    else
      return std::fprintf(stderr, "bench_engines: %s is no flag\n%s", argv[i], kUsage), 2;
  }
  if (scene.empty()) return measure_figures("out/bench/engines.html", only) ? 0 : 1;
  if (scene == "energy") return energy_over_a_million(), 0;
  const bool has_threads =
      engines.find("tw2") != std::string::npos || engines.find("tw4") != std::string::npos;
  std::printf("%-10s %7s %-8s %10s %10s %10s %8s %9s %12s %10s %12s %9s\n", "scene", "bodies",
              "engine", "int/n/s", "checks/n/s", "coll/n/s", "undone", "kept", "coll/s",
              has_threads ? "clock s" : "CPU s", "us/n/sim s", "w h");
  for (const std::string& n : parts(sizes))
    table(scene, std::atoi(n.c_str()), parts(engines), duration,
          has_threads ? Clock::kWall : Clock::kCpu);
}
