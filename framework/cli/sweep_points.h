/// The run of one point of a sweep, and what is kept of it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/cli/module_choice.h"
#include "framework/cli/sweep_values.h"
#include "framework/cli/verb.h"

namespace tumble::cli {

/// What is measured at the end of a run.
struct Measure {
  std::string word;   // on the command line: "energy", "ball.z"
  std::string title;  // for people
  std::string unit;
  bool is_error = false;  // drawn over a logarithmic axis
};

/// energy, gap, joint, collisions, cpu, or BODY.x, BODY.y, BODY.z.
/// @param words  in that form; empty: energy, gap where two bodies collide, joint
///   where there are rods or joints, cpu
/// @throws UserError for a word that is unknown or given twice
std::vector<Measure> measures_of(const std::vector<std::string>& words, const scene::Scene& scene);

/// How a run ended.
enum class PointState { kMissing, kFine, kStopped, kNotTrusted };

struct PointResult {
  PointState state = PointState::kMissing;
  std::string reason;          // why it is not fine
  bool may_pass = false;       // what stopped it is not of the point: a sandbox out of time, say
  std::vector<double> values;  // by measure; NaN where there is none
  double cpu_s = kUnset;       // of the run; compared with nothing
};

/// Runs a scene, which has the values of its point, and measures it. A scene that its engine or
/// method refuses counts as stopped, with the reason.
PointResult run_point(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                      const RunWords& words, const std::vector<Measure>& measures);

/// As text and back, bit for bit.
std::string text_of(const PointResult& result);
PointResult point_of(const std::string& text);

/// "fine", "stopped", "not trusted", "missing"
std::string name_of(PointState state);

}  // namespace tumble::cli
