/// The points at which two solids touch or soon will: what forces of lasting contact act at.
#pragma once

#include <vector>

#include "framework/collision/gap.h"

namespace tumble::collision {

struct NearPoint {
  Vector3d point_a_world;         // on A's surface [m]
  Vector3d point_b_world;         // on B's surface, straight across [m]
  Vector3d normal_b_to_a_world;   // unit
  double gap;                     // along the normal [m]
};

/// Corners of the regions of A and B that face each other less than `reach` apart, each with its own gap; sorted in a way that does not
/// depend on where they stand in the world. An ellipsoid has one point; a ball has one on a convex solid, one a
/// wall on others; a solid on a half-space those of its vertices that are near and foremost of all about them.
/// Surfaces that are not convex push along the normals of their faces, and of edges and corners that are foremost of all about them:
/// not along those of the rims between their triangles. Where faces lie flat on each other the normal is that of a face, exact however small the gap.
/// @param cache  of this pair, may be null: see pair_cache.h
/// @return empty where the two are farther apart than `reach`
std::vector<NearPoint> near_points(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b, double reach,
                                   PairCache* cache = nullptr);

}  // namespace tumble::collision
