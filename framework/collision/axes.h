/// Separating-axis test: the axis along which two convex polytopes have the largest separation, or
/// the smallest penetration. Internal to collision.
///
/// The penetration depth, and every distance except those from a corner to a corner or edge, lies
/// along a face normal of A or B or along the cross product of an edge of each (S. Gottschalk, M.
/// Lin, D. Manocha, OBBTree, SIGGRAPH 1996). Such an axis is accurate to all digits however small
/// the gap is; the difference of two near points is not.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "framework/collision/polytope.h"

namespace tumble::collision {

struct Axis {
  // along `normal`; negative: the overlap [m]
  double separation = -std::numeric_limits<double>::infinity();
  Vector3d normal_b_to_a = Vector3d::UnitZ();
};

/// Directions that no axis may have, to a millionth of a radian. Unit, frame of the query.
struct BarredAxes {
  std::optional<Vector3d> first, second;
  bool holds(const Vector3d& n) const;
};

/// The best of all axes. Separation -infinity for two points, which have no axis.
/// @param barred  may be null
/// Cost: a cross product for every pair of edge directions, and a loop over all vertices for the
/// few axes that may be the best.
Axis best_axis(const PlacedPolytope& a, const PlacedPolytope& b, double size,
               const BarredAxes* barred = nullptr);

/// The normals of all axes along which the two are at least so far apart, each once.
/// Cost: that of best_axis without its cheap rejections.
std::vector<Vector3d> axes_apart(const PlacedPolytope& a, const PlacedPolytope& b,
                                 double separation);

/// The best of the axes within about `angle` (rad) of a direction: those of the faces, edges and
/// corners that face each other along it. Separation -infinity where there is none.
Axis best_axis_near(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& direction,
                    double angle, double size);

}  // namespace tumble::collision
