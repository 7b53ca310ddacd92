/// All points at which two solids touch, as far as they share one normal.
#pragma once

#include "framework/collision/gap.h"
#include "framework/collision/patch.h"

namespace tumble::collision {

/// @param gap        of the two, as compute_gap gives it
/// @param tolerance  further points belong to the patch if they are at most this much farther apart [m]
/// @return corners and middle of the patch, world frame, on A's surface; the witness point alone where nothing else is near
FlatHull contact_patch(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b, const Gap& gap,
                       double tolerance);

}  // namespace tumble::collision
