/// The contact manifold of two solids that touch or are about to: the points at which contact
/// forces act.
#pragma once

#include <vector>

#include "framework/collision/gap.h"

namespace tumble::collision {

struct ManifoldPoint {
  Vector3d point_a_world;        // on A's surface [m]
  Vector3d point_b_world;        // on B's surface, opposite along the normal [m]
  Vector3d normal_b_to_a_world;  // unit
  double gap;                    // along the normal [m]
};

/// Corners of the regions in which A and B are less than `reach` apart, each with its own gap.
/// Their order does not depend on where the solids are in the world. An ellipsoid has one point; a
/// ball has one point on a convex solid and one per wall on other solids; a solid on a half-space
/// has those near vertices that protrude from their surroundings.
/// Contact normals of surfaces that are not convex are those of faces, and of edges and corners
/// that protrude from their surroundings, but never those of seams between triangles. Where two
/// faces lie on each other the normal is that of a face, exact however small the gap.
/// @param cache  of this pair, may be null: see pair_cache.h
/// @return empty where the solids are farther apart than `reach`
std::vector<ManifoldPoint> manifold_points(const CollisionShape& a, const Pose& pose_a,
                                           const CollisionShape& b, const Pose& pose_b,
                                           double reach, PairCache* cache = nullptr);

}  // namespace tumble::collision
