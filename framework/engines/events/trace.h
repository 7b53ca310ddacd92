/// The committed trace of a run: two runs of a scene must agree in it to the last bit, whatever the
/// engine and its order of execution. The comparison gives the first difference from the reference.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// Time, kind, bodies and impulse of every committed event, in order, as one number (FNV-1a over
/// the bits).
std::uint64_t trace_hash(const Trajectory& run);

/// The first difference of two traces.
struct TraceDifference {
  std::size_t index;  // of the first event that differs
  double time;        // [s], of the earlier of the two
  std::string story;  // the reference's event and the run's, with names
};

/// @return nothing where the traces are equal, bit for bit
std::optional<TraceDifference> compare_traces(const Trajectory& reference, const Trajectory& run);

}  // namespace tumble::engines
