/// The contact region of two convex polytopes: a point, a segment or a polygon.
#pragma once

#include <vector>

#include "framework/collision/inline_vector.h"
#include "framework/collision/polytope.h"

namespace tumble::collision {

using Corners = InlineVector<Vector3d, 16>;

/// Corners, on A's side, of the intersection of the facing parts of A and B, both projected along
/// the normal; then vertices of either inside that region. At least one point.
/// @param tolerance  a vertex belongs to the facing part up to this distance behind the foremost
///   one [m]
Corners facing_region(const PlacedPolytope& a, const PlacedPolytope& b,
                      const Vector3d& normal_b_to_a, double tolerance);

/// The centroid of that region.
Vector3d middle_of_facing_region(const PlacedPolytope& a, const PlacedPolytope& b,
                                 const Vector3d& normal_b_to_a, double tolerance);

/// Corners of the convex hull of points in a plane, and its centroid: of its area, of its length,
/// or the point itself.
struct FlatHull {
  std::vector<Vector3d> corners;
  Vector3d middle;
};
FlatHull flat_hull(const std::vector<Vector3d>& points, const Vector3d& normal);

/// The points that are corners of the hull in the projection along `normal`, counter-clockwise; of
/// coincident points the first.
InlineVector<int, 16> hull_corners(const Corners& points, const Vector3d& normal);

/// The points on which a plate, lowered along `normal` and free to tilt, could rest: corners of the
/// lower hull of the points and their heights. Corners of the flat hull come first, in its order;
/// of points with the same projection the lowest counts.
/// @param heights    along `normal`, by point [m]
/// @param tolerance  a point less than this below the hull of the others is not a corner [m]
InlineVector<int, 16> lower_corners(const Corners& points, const InlineVector<double, 16>& heights,
                                    const Vector3d& normal, double tolerance);

}  // namespace tumble::collision
