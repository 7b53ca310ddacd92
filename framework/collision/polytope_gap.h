/// Signed distance between two convex polytopes.
///
/// Apart: the algorithm of Gilbert, Johnson and Keerthi. Touching or overlapping: the largest
/// separation over all possible separating axes, which is continuous through zero, so that a root
/// finder sees a change of sign. The axis is searched near the direction of the nearest points or
/// of the expanding polytope algorithm; their bounds certify that it is the best one, and otherwise
/// all axes are tested. All tolerances scale with the sizes.
#pragma once

#include <limits>

#include "framework/collision/polytope.h"

namespace tumble::collision {

/// Signed distance and witness points.
struct PolytopeGap {
  // > 0 apart; <= 0: largest separation over all axes, the negative penetration depth [m]
  double distance;
  Vector3d point_a, point_b;
  Vector3d normal_b_to_a;  // unit
  // farther apart than the limit: `distance` is a lower bound, along the normal, and the points are
  // not set
  bool beyond = false;
};

enum class Points { kWanted, kUnwanted };

/// @param size   distance of the points from the origin of the query, with which round-off scales
///   [m]
/// @param limit  larger distances need not be exact [m]
/// Error: a few roundings of `size`.
/// @param points whether the nearest points are needed too
PolytopeGap polytope_gap(const PlacedPolytope& a, const PlacedPolytope& b, double size,
                         double limit = std::numeric_limits<double>::infinity(),
                         Points points = Points::kWanted);

}  // namespace tumble::collision
