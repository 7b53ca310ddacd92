/// The axis along which two convex polytopes lie farthest apart, or overlap least. Internal to collision.
///
/// A smallest overlap, and a distance between faces, edges and corners that is no corner's, lies along the normal of a face of A or
/// B or across an edge of each (S. Gottschalk, M. Lin, D. Manocha, OBBTree, SIGGRAPH 1996). Such an axis has all its digits however
/// small the gap is, which the difference of two near points has not.
#pragma once

#include <limits>

#include "framework/collision/polytope.h"

namespace tumble::collision {

struct Axis {
  double separation = -std::numeric_limits<double>::infinity();   // along `normal`; negative: the overlap [m]
  Vector3d normal_b_to_a = Vector3d::UnitZ();
};

/// The best of all axes. Separation -infinity for two points, which have none.
/// Cost: a product for every pair of edge directions, and all vertices for the few axes that may be the best.
Axis best_axis(const PlacedPolytope& a, const PlacedPolytope& b, double size);

/// The best of the axes that lie about as near to a direction as `angle` (rad): those of the faces, edges and corners that face each
/// other along it. Separation -infinity where there are none.
Axis best_axis_near(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& direction, double angle, double size);

}  // namespace tumble::collision
