/// Where two convex polytopes touch: a point, a segment or a polygon.
#pragma once

#include <vector>

#include "framework/collision/inline_vector.h"
#include "framework/collision/polytope.h"

namespace tumble::collision {

using Corners = InlineVector<Vector3d, 16>;

/// Corners of the region that the parts of A and B facing each other along `n` share, seen along `n`, on A's side, then vertices of either
/// that lie inside of it. At least one.
/// @param tolerance  how far behind the foremost vertex another still belongs to the facing part [m]
Corners facing_region(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& normal_b_to_a, double tolerance);

/// The middle of that region.
Vector3d middle_of_facing_region(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& normal_b_to_a, double tolerance);

/// Corners of the convex hull of points in a plane, and the middle of that hull: of its area, its length, or the point itself.
struct FlatHull {
  std::vector<Vector3d> corners;
  Vector3d middle;
};
FlatHull flat_hull(const std::vector<Vector3d>& points, const Vector3d& normal);

/// Which of the points are corners of their hull seen along `normal`, counter-clockwise; of points that coincide, the first.
InlineVector<int, 16> hull_corners(const Corners& points, const Vector3d& normal);

/// Which of the points a plate would touch that comes down on them along `normal` and may lean: corners of the lower side of the hull of
/// their places and heights. Those of the flat hull first, in its order; of points one above another the lowest.
/// @param heights    along `normal`, by point [m]
/// @param tolerance  a point that lies less than this below what lies between others is none [m]
InlineVector<int, 16> lower_corners(const Corners& points, const InlineVector<double, 16>& heights, const Vector3d& normal, double tolerance);

}  // namespace tumble::collision
