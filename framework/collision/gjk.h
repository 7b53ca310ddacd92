/// Distance of two separate convex polytopes: the algorithm of Gilbert, Johnson and Keerthi (GJK)
/// on their Minkowski difference A - B.
/// Source: G. van den Bergen, Collision Detection in Interactive 3D Environments, 2003, ch. 4.
/// Internal to collision.
#pragma once

#include "framework/collision/polytope.h"
#include "framework/collision/simplex.h"

namespace tumble::collision {

enum class Apartness {
  kApart,
  kBeyond,    // farther apart than the limit: by at least `lower_bound` along `normal`
  kTouching,  // the distance is at most a few roundings
  kEnclosed,  // overlapping: the simplex is a tetrahedron of points of A - B around the origin
};

struct GjkResult {
  Apartness verdict;
  Simplex simplex;
  // of the simplex from the origin: an upper bound of the solids' distance [m]
  double distance;
  Vector3d normal;           // from the origin to the nearest point of the simplex; unit
  double lower_bound = 0.0;  // of the distance [m]
};

/// The lowest corner of A - B along a direction.
DifferencePoint lowest_difference(const PlacedPolytope& a, const PlacedPolytope& b,
                                  const Vector3d& direction);

/// @param size   distance of the points from the origin of the query, with which round-off scales
///   [m]
/// @param limit  larger distances need not be exact [m]
GjkResult gjk(const PlacedPolytope& a, const PlacedPolytope& b, double size, double limit);

}  // namespace tumble::collision
