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
  // of two faces that touch and bound no gap of their solids: see surface_gap
  bool grazes = false;
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

/// The same of two pieces of which some are faces of solids. Faces have an outer and an inner side:
/// what touches a face from the inside is within the solid, or beside it at an edge of the face.
/// Along a direction into which a face of A looks, or against which one of B does, two that touch
/// are therefore not apart. Without those directions
///  - faces in one plane that look to the same side are as far apart as they are in that plane, and
///    overlap where they do there: solids that are aligned enter each other so;
///  - a face with an edge in the inner side of another is as deep as the other reaches across it;
///  - two that are beneath each other, edge along edge, graze: other faces of their solids touch
///    there too, and face each other.
/// Pieces that are apart, or cross, have the gap of polytope_gap, to the last bit.
PolytopeGap surface_gap(const PlacedPolytope& a, const PlacedPolytope& b, double size,
                        double limit = std::numeric_limits<double>::infinity(),
                        Points points = Points::kWanted);

}  // namespace tumble::collision
