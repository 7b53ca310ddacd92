/// Distance between two convex polytopes, signed where they touch or overlap.
///
/// Apart: the algorithm of Gilbert, Johnson and Keerthi. In touch or overlapping: the largest separation over the axes that can
/// separate two polytopes, which is smooth through zero, so that a root finder sees a sign change. The axis is looked for where the
/// nearest points or the expanding polytope algorithm say; that it is the best of all is certified by their bounds, and where it is
/// not, all axes are tried. No absolute tolerance anywhere: all scale with the sizes.
#pragma once

#include <limits>

#include "framework/collision/polytope.h"

namespace tumble::collision {

/// How two polytopes lie to each other.
struct PolytopeGap {
  double distance;        // > 0 apart; <= 0: largest separation over all axes, minus the depth of overlap [m]
  Vector3d point_a, point_b;
  Vector3d normal_b_to_a; // unit
  bool beyond = false;    // farther than asked: `distance` is a lower bound of it along the normal, the points are not set
};

enum class Points { kWanted, kUnwanted };

/// @param size   a length to scale round-off by: how far the points lie from the origin of the query [m]
/// @param limit  a distance beyond it need not be known, only told [m]
/// Error: a few roundings of `size`.
/// @param points whether the nearest points are set, too
PolytopeGap polytope_gap(const PlacedPolytope& a, const PlacedPolytope& b, double size, double limit = std::numeric_limits<double>::infinity(),
                         Points points = Points::kWanted);

}  // namespace tumble::collision
