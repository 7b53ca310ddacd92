/// Runs with the laws of all reference modules, by an engine's name.
#pragma once

#include <string>
#include <utility>

#include "tests/engines/event_scenes.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {

inline Trajectory run_on(const std::string& engine, const scene::Scene& scene) {
  static const Laws laws = reference_laws();
  engines::RunOptions options;
  options.engine = engine;
  return run_as_told(std::move(options), scene, laws);
}

}  // namespace tumble::testing
