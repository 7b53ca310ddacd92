/// How far two solids are apart, where they are nearest, and which way they would be pushed.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "framework/collision/collision_shape.h"
#include "framework/collision/pair_cache.h"

namespace tumble::collision {

/// Two solids at one instant. World frame.
struct Gap {
  double distance;               // [m]; > 0 apart, 0 touching, < 0 overlapping
  Vector3d point_a_world;        // witness points: the nearest points of the two surfaces [m]
  Vector3d point_b_world;
  Vector3d normal_b_to_a_world;  // unit
};

/// The gap between two solids.
/// Round shapes and half-spaces: closed forms, also when overlapping. Polytopes: see polytope_gap.h. Surfaces that are not
/// convex: the smallest over their faces; an overlap is any negative number, and a solid wholly inside another is not
/// noticed here (see `overlapping`).
/// @param cache  of this pair, may be null: see pair_cache.h
/// @return distance to a few roundings of the solids' size and of the distance of their centres. Infinite between two half-spaces.
Gap compute_gap(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b, PairCache* cache = nullptr);

/// A bound from below for next to nothing: the gap of the balls around the two; against a half-space of the ball and it. [m]
inline double least_gap(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b) {
  const Vector3d between = pose_a.com_world - pose_b.com_world;
  if (b.is_half_space()) return (pose_b.world_from_body * Vector3d::UnitZ()).dot(between) - a.bounding_radius();
  if (a.is_half_space()) return -(pose_a.world_from_body * Vector3d::UnitZ()).dot(between) - b.bounding_radius();
  return between.norm() - a.bounding_radius() - b.bounding_radius();
}
/// The same distance to the last bit, sooner: without the nearest points. [m]
/// @param limit  of gaps larger than this no more is asked than that they are [m]
/// @return the distance, or where it is above the limit any bound from below that is above the limit as well
double gap_distance(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b, PairCache* cache = nullptr,
                    double limit = std::numeric_limits<double>::infinity());

/// Whether two solids share a point of their insides, also when one lies wholly inside the other. For initial states.
/// @param allowance  an overlap this deep still counts as touching [m]
bool overlapping(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b, double allowance);

/// A length whose round-off bounds that of a gap: the solids' sizes and the distance of their centres. [m]
double gap_scale(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b);

}  // namespace tumble::collision
