#include "tests/fuzz/run_here.h"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/engines/judge.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/reference_laws.h"

namespace tumble::fuzz {
namespace {

const Laws& laws() {
  static const Laws all = testing::reference_laws();
  return all;
}

int run_and_tell(const std::filesystem::path& scene_file, const std::string& engine, const std::filesystem::path& record) {
  const scene::Scene scene = scene::load_scene(scene_file);
  engines::RunOptions options;
  options.engine = engine;
  options.timewarp = engines::fast_timewarp();
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws(), options, recorder);
  const Trajectory& run = recorder.trajectory();
  nlohmann::ordered_json page{{"stopped_by", run.stopped_by}, {"notices", run.counters.notices}, {"checks", nlohmann::json::array()}};
  bool passed = run.stopped_by.empty();
  for (const engines::CheckResult& check : engines::judge_run(scene, run)) {
    page["checks"].push_back({{"kind", check.kind}, {"passed", check.passed}, {"value", check.value}, {"threshold", check.threshold}, {"detail", check.detail}});
    passed = passed && check.passed;
  }
  std::printf("%s\n", page.dump().c_str());
  write_trajectory(record, run);
  return passed ? 0 : 1;
}

}  // namespace

void load_laws() { laws(); }

int run_here(const std::filesystem::path& scene_file, const std::string& engine, const std::filesystem::path& record) {
  try {
    return run_and_tell(scene_file, engine, record);
  } catch (const UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(ExitCode::kUserError);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(ExitCode::kOurBug);
  }
}

}  // namespace tumble::fuzz
