/// Judges a recorded run by numbers: what the scene's `checks` ask. Reads scene and trajectory, never an engine.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

struct CheckResult {
  std::string kind;        // as in the scene
  std::string subject;     // the body, or "all"
  double value;            // what was reached: an error, a drift, a smallest gap
  double threshold;        // what was allowed
  std::string unit;
  bool passed;
  std::string why;         // the threshold's reason
};

/// One result a check, in the scene's order. @throws UserError for a kind of check that is not known.
std::vector<CheckResult> judge_run(const scene::Scene& scene, const Trajectory& run);

}  // namespace tumble::engines
