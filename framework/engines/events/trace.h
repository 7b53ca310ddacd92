/// The committed trace of a run: what two runs of a scene must share to the last bit, whatever engine made them and in whatever order it
/// worked. And the judge that says where a run first leaves the reference.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// Time, kind, bodies and impulse of every committed event, in order, as one number (FNV-1a over the bits).
std::uint64_t trace_hash(const Trajectory& run);

/// Where two traces part.
struct TraceDifference {
  std::size_t index;          // of the first event that differs
  double time;                // [s], of the earlier of the two
  std::string story;          // what the reference has there, what the run has there, with names
};

/// @return nothing where the traces are equal, bit for bit
std::optional<TraceDifference> compare_traces(const Trajectory& reference, const Trajectory& run);

}  // namespace tumble::engines
