/// The contact patch of two solids: the points of contact that share one normal.
#pragma once

#include "framework/collision/gap.h"
#include "framework/collision/patch.h"

namespace tumble::collision {

/// @param gap        of the two solids, from compute_gap
/// @param tolerance  a point belongs to the patch if its gap is at most this much larger [m]
/// @return corners and centroid of the patch, world frame, on A's surface; only the witness point
///   where no other point is near
FlatHull contact_patch(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                       const Pose& pose_b, const Gap& gap, double tolerance);

}  // namespace tumble::collision
