/// The smallest rotation that takes one direction to another: Eigen's FromTwoVectors without its
/// singular value decomposition, which costs every file that calls it ten seconds of compile time.
#pragma once

#include "framework/core/math.h"

namespace tumble {

/// Rotates the direction of `from` to that of `to`, about an axis perpendicular to both. Neither
/// needs unit length; neither may be 0. Opposite directions need half a turn, about a perpendicular
/// axis that depends on `from` only.
Quaterniond shortest_turn(const Vector3d& from, const Vector3d& to);

}  // namespace tumble
