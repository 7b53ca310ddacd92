#include "tests/fuzz/run_here.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/engines/judging/judge.h"
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

/// Writes a byte for each frame, for the watching process.
class Footprints final : public TrajectorySink {
 public:
  Footprints(TrajectorySink& sink, const std::filesystem::path& file)
      : sink_(sink), file_(file, std::ios::trunc) {}
  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override {
    sink_.begin(info, bodies);
  }
  void frame(const Frame& frame) override {
    file_.put('.').flush();
    sink_.frame(frame);
  }
  void event(const Event& event) override { sink_.event(event); }
  void end(const Counters& counters, const std::string& stopped_by) override {
    sink_.end(counters, stopped_by);
  }

 private:
  TrajectorySink& sink_;
  std::ofstream file_;
};

int run_and_tell(const std::filesystem::path& scene_file, const std::string& engine,
                 const std::filesystem::path& record) {
  const scene::Scene scene = scene::load_scene(scene_file);
  engines::RunOptions options;
  options.engine = engine;
  options.timewarp = engines::fast_timewarp();
  TrajectoryRecorder recorder;
  Footprints footprints(recorder, progress_of(record));
  engines::run_scene(scene, laws(), options, footprints);
  const Trajectory& run = recorder.trajectory();
  nlohmann::ordered_json page{{"stopped_by", run.stopped_by},
                              {"notices", run.counters.notices},
                              {"checks", nlohmann::json::array()}};
  bool passed = run.stopped_by.empty();
  for (const engines::CheckResult& check : engines::judge_run(scene, run)) {
    page["checks"].push_back({{"kind", check.kind},
                              {"passed", check.passed},
                              {"value", check.value},
                              {"threshold", check.threshold},
                              {"detail", check.detail}});
    passed = passed && check.passed;
  }
  std::printf("%s\n", page.dump().c_str());
  write_trajectory(record, run);
  return passed ? 0 : 1;
}

}  // namespace

void load_laws() { laws(); }

std::filesystem::path progress_of(const std::filesystem::path& record) {
  return record.string() + ".progress";
}

int run_here(const std::filesystem::path& scene_file, const std::string& engine,
             const std::filesystem::path& record) {
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
