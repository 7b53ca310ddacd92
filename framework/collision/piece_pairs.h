/// Finds the near pairs of convex pieces of two solids. Internal to collision.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "framework/collision/collision_shape.h"
#include "framework/collision/pair_cache.h"
#include "framework/collision/polytope_gap.h"

namespace tumble::collision {

/// Two solids in the frame of a query: origin at B's centre of mass, axes of the world. A pair far
/// from the world's origin loses no digits.
struct Query {
  const CollisionShape& a;
  const CollisionShape& b;
  Matrix3d rotation_a, rotation_b;
  Vector3d offset;  // centre of A minus centre of B [m]
  double size;      // [m]

  Query(const CollisionShape& shape_a, const Pose& pose_a, const CollisionShape& shape_b,
        const Pose& pose_b)
      : a(shape_a),
        b(shape_b),
        rotation_a(pose_a.world_from_body.toRotationMatrix()),
        rotation_b(pose_b.world_from_body.toRotationMatrix()),
        offset(pose_a.com_world - pose_b.com_world),
        size(offset.norm() + (a.is_half_space() ? 0.0 : a.bounding_radius()) +
             (b.is_half_space() ? 0.0 : b.bounding_radius())) {}

  PlacedPolytope piece_of_a(int i) const { return {&a.pieces()[i], rotation_a, offset}; }
  PlacedPolytope piece_of_b(int j) const { return {&b.pieces()[j], rotation_b, Vector3d::Zero()}; }
};

/// The nearest pair of pieces; of equals, the first.
/// @pre neither solid is a half-space
struct NearestPieces {
  int piece_a = -1, piece_b = -1;  // -1: all are farther apart than the limit
  PolytopeGap gap{std::numeric_limits<double>::infinity(), Vector3d::Zero(), Vector3d::Zero(),
                  Vector3d::UnitZ()};
};
/// @param limit  pairs farther apart are ignored [m]
/// @param cache  may be null
/// @param points whether the nearest points are needed too
NearestPieces nearest_pieces(const Query& query, double limit, PairCache* cache, Points points);

/// The gap of two solids of one piece each, from polytope_gap.
/// @param limit, cache, points  as above
PolytopeGap convex_gap(const Query& query, double limit, PairCache* cache, Points points);

/// Pairs of pieces that may be within `reach` of each other, sorted: all that are, and some others.
std::vector<std::pair<int, int>> pieces_within(const Query& query, double reach, PairCache* cache);

}  // namespace tumble::collision
