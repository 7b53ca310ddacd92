#include "framework/engines/judging/measures.h"

#include <fmt/format.h>

#include "framework/core/error.h"

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
  // Frames are recorded at multiples of the frame time; rounding shifts them by far less than a
  // microsecond.
  constexpr double kSameInstant = 1e-6;  // s
  for (const Frame& frame : run.frames)
    if (std::abs(frame.time - time) <= kSameInstant) return &frame;
  return nullptr;
}

}  // namespace tumble::engines
