/// Distance between two convex polytopes, signed where they touch or overlap. Knows points only: no poses, no radii.
///
/// Apart: the algorithm of Gilbert, Johnson and Keerthi on the Minkowski difference A - B. In touch or overlapping: the
/// largest separation over the axes that can separate two polytopes (face normals, cross products of edges), which is
/// smooth through zero, so that a root finder sees a sign change. No absolute tolerance anywhere: all scale with the sizes.
#pragma once

#include <vector>

#include "framework/core/math.h"

namespace tumble::collision {

/// The convex hull of a few points, with the directions that can separate it from another. Body frame.
struct Polytope {
  std::vector<Vector3d> vertices;          // at least one [m]
  std::vector<Vector3d> face_normals;      // unit, outward; a flat triangle has both sides and its three rims
  std::vector<Vector3d> edge_directions;   // unit, each direction once
};

/// A polytope where it stands now: vertices in the frame of the query, directions turned into it.
struct PlacedPolytope {
  const Polytope* polytope = nullptr;
  Matrix3d query_from_body;
  std::vector<Vector3d> vertices;

  void place(const Polytope& shape, const Matrix3d& rotation, const Vector3d& translation);
};

/// How two polytopes lie to each other.
struct PolytopeGap {
  double distance;        // > 0 apart; <= 0: largest separation over all axes, minus the depth of overlap [m]
  Vector3d point_a, point_b;
  Vector3d normal_b_to_a; // unit
};

/// @param size  a length to scale round-off by: how far the points lie from the origin of the query [m]
/// Source: G. van den Bergen, Collision Detection in Interactive 3D Environments, 2003, ch. 4; S. Gottschalk, M. Lin,
/// D. Manocha, OBBTree, SIGGRAPH 1996 (separating axes). Error: a few roundings of `size`.
PolytopeGap polytope_gap(const PlacedPolytope& a, const PlacedPolytope& b, double size);

/// min over A of n.a minus max over B of n.b: how far the two lie apart along `n`. [m]
double separation_along(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& normal_b_to_a);

}  // namespace tumble::collision
