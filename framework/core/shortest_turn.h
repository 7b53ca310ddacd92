/// The rotation about the axis across both that carries one direction onto another: what Eigen's FromTwoVectors does, without
/// the singular value decomposition that every file that calls it compiles (ten seconds each).
#pragma once

#include "framework/core/math.h"

namespace tumble {

/// Carries the direction of `from` onto that of `to`; neither needs unit length, neither may be 0. Opposite directions are joined
/// by a half turn about an axis across them that depends on `from` alone.
Quaterniond shortest_turn(const Vector3d& from, const Vector3d& to);

}  // namespace tumble
