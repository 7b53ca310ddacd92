// Row 33: bodies at their own local times, and one that comes late.
#include <fmt/format.h>

#include "framework/engines/events/trace.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

/// Elastic balls that fly to and fro in a box, each meeting another every few tenths of a second: whoever has gone ahead alone is met by
/// one that comes late.
scene::Scene gas(int n) {
  scene::Scene scene = scene::make_sized_scene("gas", n);
  scene.duration_s = 1.5;
  return scene;
}

Trajectory run_by(const std::string& engine, const scene::Scene& scene, const Laws& laws, const engines::TimewarpTrial& trial = {}) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = engine;
  options.timewarp = engines::fast_timewarp();
  options.trial = trial;
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

/// How many bodies of frames are not, bit for bit, where the other run has them; 1e9 where events differ.
double differences(const Trajectory& a, const Trajectory& b) {
  if (a.frames.size() != b.frames.size() || engines::compare_traces(a, b)) return 1e9;
  double count = 0.0;
  for (std::size_t k = 0; k < a.frames.size(); ++k)
    for (std::size_t i = 0; i < a.bodies.size(); ++i)
      if (a.frames[k].poses[i].com_world != b.frames[k].poses[i].com_world || a.frames[k].poses[i].world_from_body.coeffs() != b.frames[k].poses[i].world_from_body.coeffs()) ++count;
  return count;
}

void rollback(const Given& given, Findings& findings) {
  if (!engines::fast_timewarp()) return findings.not_run("timewarp", "this tree has no scheduler of its own: --modules a4=... brings one");
  const scene::Scene scene = gas(60);
  Laws laws = given.laws;
  laws.scheduling = {};   // the fast scheduler is tried here; a module's decisions are tried by its assignment
  const Trajectory reference = run_by("ordered", scene, laws);
  const int seeds = given.is_long ? 200 : 20;
  double worst = 0.0;
  std::uint64_t rollbacks = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Trajectory run = run_by("tw", scene, laws, {static_cast<std::uint64_t>(seed), true, 0.25, 10, 0.05});
    worst = std::max(worst, differences(reference, run));
    rollbacks += run.counters.counts.at("rollbacks");
  }
  const Trajectory plain = run_by("tw", scene, laws);
  const std::uint64_t undone = plain.counters.counts.at("undone_integrations"), done = plain.counters.counts.at("integrations");
  findings.at_most(fmt::format("{} orders of processing by lot: bodies of frames that differ from the run in order of time", seeds), worst, 0.0, "", "bit by bit: rolled back is as if it had never been");
  findings.at_least(fmt::format("{} orders of processing by lot: rollbacks a run", seeds), static_cast<double>(rollbacks) / seeds, 10.0, "", "else nothing was tried");
  findings.at_most("in its own order: integrations undone", static_cast<double>(undone) / static_cast<double>(done), 0.15, "", "work in proportion to the events: at most 15 % of it for nothing");
  // Steps for all bodies end where any of them meets something: the same motion, rounded differently, and impacts multiply that.
  const Trajectory steps = run_by("rd", scene, laws);
  double parted = 0.0;
  for (std::size_t k = 0; k < std::min(reference.frames.size(), steps.frames.size()); ++k)
    for (std::size_t i = 0; i < reference.bodies.size(); ++i) parted += reference.frames[k].poses[i].com_world != steps.frames[k].poses[i].com_world ? 1.0 : 0.0;
  findings.must_fail("retroactive detection in steps: bodies of frames that differ in any bit", parted, 0.0, "", "it cuts every flight where any body meets anything");
}

}  // namespace

void add_rollbacks(std::vector<Case>& cases) {
  cases.push_back({33, "timewarp rollback", "Many bodies at their own local times, one of which comes late and sends others back: the result may not depend on the order of processing, bit by bit.", "a1", rollback});
}

}  // namespace tumble::battery
