/// Distance of two solids, their witness points and their contact normal.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "framework/collision/collision_shape.h"
#include "framework/collision/pair_cache.h"

namespace tumble::collision {

/// Two solids at one instant. World frame.
struct Gap {
  double distance;         // [m]; > 0 apart, 0 touching, < 0 overlapping
  Vector3d point_a_world;  // witness points: the nearest points of the two surfaces [m]
  Vector3d point_b_world;
  Vector3d normal_b_to_a_world;  // unit
};

/// The gap between two solids.
/// Round shapes and half-spaces: closed forms, also when overlapping. Polytopes: see
/// polytope_gap.h. Surfaces that are not convex: the minimum over their faces, which have an inner
/// and an outer side (`surface_gap`); an overlap gives some negative number, also where no face
/// crosses another because the solids are aligned; a solid entirely inside another is not detected
/// (see `overlapping`). Where such surfaces touch, the normal is one that separates all parts that
/// touch there (touching_normal.h).
/// @param cache  of this pair, may be null: see pair_cache.h
/// @return distance with an error of a few roundings of the solids' size and of the distance of
///   their centres. Infinite between two half-spaces.
Gap compute_gap(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                const Pose& pose_b, PairCache* cache = nullptr);

/// A cheap lower bound of the gap, by the bounding balls. [m]
inline double least_gap(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                        const Pose& pose_b) {
  const Vector3d between = pose_a.com_world - pose_b.com_world;
  if (b.is_half_space())
    return (pose_b.world_from_body * Vector3d::UnitZ()).dot(between) - a.bounding_radius();
  if (a.is_half_space())
    return -(pose_a.world_from_body * Vector3d::UnitZ()).dot(between) - b.bounding_radius();
  return between.norm() - a.bounding_radius() - b.bounding_radius();
}
/// The distance of compute_gap, equal to the last bit, but cheaper: without the witness points. [m]
/// @param limit  larger distances need not be exact [m]
/// @return the distance; where it is above the limit, a lower bound that is above the limit too
double gap_distance(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                    const Pose& pose_b, PairCache* cache = nullptr,
                    double limit = std::numeric_limits<double>::infinity());

/// Whether the gap is at most `reach`: gap_distance(..., reach) <= reach, but cheaper where the
/// cache still knows two points of convex solids that are.
bool is_within(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
               const Pose& pose_b, double reach, PairCache* cache);

/// Whether both are convex and have corners, or are half-spaces: separations along directions are
/// known of such.
bool has_separations(const CollisionShape& a, const CollisionShape& b);
/// A direction and how far two solids are apart along it. World frame.
struct Separation {
  double distance;               // [m]
  Vector3d normal_b_to_a_world;  // unit
};
/// The gap of compute_gap and its normal. @return nothing where it is above the limit [m]
/// @pre has_separations(a, b)
std::optional<Separation> largest_separation(const CollisionShape& a, const Pose& pose_a,
                                             const CollisionShape& b, const Pose& pose_b,
                                             PairCache* cache, double limit);
/// Along one direction: a lower bound of the gap, unless that is negative. [m]
/// @pre has_separations(a, b)
double separation_along(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                        const Pose& pose_b, const Vector3d& normal_b_to_a_world);

/// Of two boxes, or other convex solids of few corners, that touch corner on corner, or edge on
/// parallel edge: all normals of faces and pairs of edges along which they are apart. Which of them
/// their gap has is decided by a rounding. What lies between them, too, keeps the two apart.
/// @param gap  theirs
/// @return nothing of solids that have one normal, or are apart, and of all others
std::vector<Vector3d> normals_apart(const CollisionShape& a, const Pose& pose_a,
                                    const CollisionShape& b, const Pose& pose_b, const Gap& gap);

/// Whether the interiors of two solids intersect, also when one lies entirely inside the other. For
/// initial states.
/// @param allowance  a penetration up to this depth counts as touching [m]
bool overlapping(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                 const Pose& pose_b, double allowance);

/// The length with which the rounding error of a gap scales: the solids' sizes and the distance of
/// their centres. [m]
double gap_scale(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b,
                 const Pose& pose_b);

}  // namespace tumble::collision
