/// Distance of two convex polytopes that lie apart: the algorithm of Gilbert, Johnson and Keerthi on their difference A - B.
/// Source: G. van den Bergen, Collision Detection in Interactive 3D Environments, 2003, ch. 4. Internal to collision.
#pragma once

#include "framework/collision/polytope.h"
#include "framework/collision/simplex.h"

namespace tumble::collision {

enum class Apartness {
  kApart,
  kBeyond,     // farther than the limit: along `normal`, by `lower_bound` at least
  kTouching,   // by a few roundings at most
  kEnclosed,   // the simplex is a tetrahedron of points of A - B around the origin
};

struct GjkResult {
  Apartness verdict;
  Simplex simplex;
  double distance;            // of the nearest point of the simplex: an upper bound of that of the solids [m]
  Vector3d normal;            // from the origin to that point; unit
  double lower_bound = 0.0;   // of the distance, proved [m]
};

/// Corner of A - B that lies lowest along a direction.
DifferencePoint lowest_difference(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& direction);

/// @param size   how far the points lie from the origin of the query: what round-off scales with [m]
/// @param limit  distances beyond it are of no interest [m]
GjkResult gjk(const PlacedPolytope& a, const PlacedPolytope& b, double size, double limit);

}  // namespace tumble::collision
