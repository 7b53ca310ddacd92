/// Runs with the laws of all reference modules, by an engine's name.
#pragma once

#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/engines/event_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {

inline Trajectory run_on(const std::string& engine, const scene::Scene& scene) {
  static const Laws laws = reference_laws();
  engines::RunOptions options;
  options.engine = engine;
  return run_as_told(std::move(options), scene, laws);
}

/// One that goes to its end, and reports nothing.
inline Trajectory run_well(const std::string& engine, const scene::Scene& scene) {
  Trajectory run = run_on(engine, scene);
  EXPECT_EQ(run.stopped_by, "");
  EXPECT_EQ(faults_of(run), "");
  return run;
}

}  // namespace tumble::testing
