#include "framework/engines/judging/measures.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {

std::string at_time(double time) { return fmt::format("at t = {:.6g} s", time); }

int index_of(const std::string& name, const Trajectory& run) {
  for (std::size_t i = 0; i < run.bodies.size(); ++i)
    if (run.bodies[i].name == name) return static_cast<int>(i);
  throw UserError("check", "the run has no body '" + name + "'",
                  "Judge a run by the scene that it was made from.");
}

const Frame* frame_at(double time, const Trajectory& run) {
  if (time == 0.0) return &run.frames.back();
  const auto distance = [&](const Frame& frame) { return std::abs(frame.time - time); };
  const auto nearest =
      std::min_element(run.frames.begin(), run.frames.end(),
                       [&](const Frame& a, const Frame& b) { return distance(a) < distance(b); });
  return distance(*nearest) <= kSameInstant ? &*nearest : nullptr;
}

}  // namespace tumble::engines
