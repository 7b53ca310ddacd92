/// Shared by tests of event-driven engines: runs by engine, and a sentence for the first difference
/// of a trace from the reference.
#pragma once

#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "framework/engines/events/trace.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "tests/engines/scenes.h"

namespace tumble::testing {

/// @param options  of the run; its timewarp engine may be empty
inline Trajectory run_as_told(engines::RunOptions options, const scene::Scene& scene,
                              const Laws& laws) {
  TrajectoryRecorder recorder;
  options.timewarp = engines::fast_timewarp();
  engines::run_scene(scene, laws, options, recorder);
  return recorder.trajectory();
}

inline Trajectory run_by(const std::string& engine, const scene::Scene& scene,
                         const engines::FaultInjection& faults = {}, double frame_rate_hz = 60.0,
                         const Laws& laws = test_laws()) {
  engines::RunOptions options;
  options.engine = engine;
  options.faults = faults;
  options.frame_rate_hz = frame_rate_hz;
  return run_as_told(std::move(options), scene, laws);
}

/// What a run finds wrong with itself, a line each; numbers to the last digit.
inline std::string faults_of(const Trajectory& run) {
  const auto exact = [](double number) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", number);
    return std::string(digits);
  };
  std::string faults;
  for (const RunFault& fault : run.counters.faults)
    faults += fault.kind + " of " + fault.subject + ", " + std::to_string(fault.count) +
              " times, first at " + exact(fault.first_s) + " s, at worst " + exact(fault.worst) +
              " at " + exact(fault.worst_s) + " s; " + fault.remedy + "\n";
  return faults;
}

/// Empty where two runs committed the same events and frames, and found the same faults; else their
/// first difference.
inline std::string difference(const Trajectory& reference, const Trajectory& run) {
  if (const auto parted = engines::compare_traces(reference, run)) return parted->story;
  if (reference.stopped_by != run.stopped_by)
    return "one stopped: '" + reference.stopped_by + "' and '" + run.stopped_by + "'";
  if (reference.frames.size() != run.frames.size())
    return "frames: " + std::to_string(reference.frames.size()) + " and " +
           std::to_string(run.frames.size());
  for (std::size_t k = 0; k < reference.frames.size(); ++k)
    for (std::size_t i = 0; i < reference.bodies.size(); ++i)
      if (reference.frames[k].poses[i].com_world != run.frames[k].poses[i].com_world ||
          reference.frames[k].poses[i].world_from_body.coeffs() !=
              run.frames[k].poses[i].world_from_body.coeffs())
        return "frame " + std::to_string(k) + ": body " + reference.bodies[i].name +
               " is elsewhere";
  if (const std::string expected = faults_of(reference), found = faults_of(run); expected != found)
    return "faults:\n" + expected + "and\n" + found;
  return "";
}

inline scene::Scene sized(const std::string& name, int n, double duration) {
  scene::Scene scene = scene::make_sized_scene(name, n);
  scene.duration_s = duration;
  return scene;
}

/// Timewarp and conservative advancement commit what the reference commits, which is more than
/// `least` events.
inline void expect_the_references_trace(const scene::Scene& scene, std::size_t least) {
  const Trajectory reference = run_by("ordered", scene);
  ASSERT_GT(reference.events.size(), least);
  EXPECT_EQ(difference(reference, run_by("tw", scene)), "");
  EXPECT_EQ(difference(reference, run_by("ca", scene)), "");
}

}  // namespace tumble::testing
