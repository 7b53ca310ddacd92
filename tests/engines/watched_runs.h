/// Runs by any engine, and what their watch tells of them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/reference_laws.h"
#include "tests/engines/scenes.h"
#include "tests/support/places.h"

namespace tumble::testing {

inline const Vector3d kEarthGravity(0, 0, -9.81);  // [m/s^2]

/// Of tests/engines/broken_scenes.
inline scene::Scene broken_scene(const std::string& name) {
  return scene::load_scene(std::filesystem::path(test::source_dir()) /
                           "tests/engines/broken_scenes" / (name + ".json"));
}

inline Trajectory run_by(const std::string& engine, scene::Scene scene,
                         const Laws& laws = reference_laws()) {
  if (scene.contact && engine != "rd") scene.contact->sleep = false;  // which it refuses
  engines::RunOptions options;
  options.engine = engine;
  options.timewarp = engines::fast_timewarp();
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

inline bool has_fault(const Trajectory& run, const std::string& kind) {
  return std::any_of(run.counters.faults.begin(), run.counters.faults.end(),
                     [&](const RunFault& fault) { return fault.kind == kind; });
}

inline std::string said(const Trajectory& run) {
  std::string all = run.stopped_by;
  for (const RunFault& fault : run.counters.faults)
    all += fmt::format("\n{} of {}: {:.3g} first at {:.3g} s", fault.kind, fault.subject,
                       fault.worst, fault.first_s);
  for (const std::string& notice : run.counters.notices) all += "\nnote " + notice;
  return all;
}

}  // namespace tumble::testing
