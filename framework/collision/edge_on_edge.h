/// The contact normal of two solids where an edge of one lies along an edge of the other. Internal
/// to collision.
///
/// Two such edges touch along a line, and every direction in the intersection of their normal cones
/// is a contact normal; the direction between the nearest points is only rounding, or the offset of
/// the contact margin. A force may act along any of these normals. The middle one is returned: it
/// does not depend on the last digit, and it respects mirror symmetry.
///
///   n in cone(B's edge), -n in cone(A's edge):  angles about the edge in [low, high];  normal at
///   (low + high) / 2
#pragma once

#include <array>
#include <optional>

#include "framework/collision/polytope.h"

namespace tumble::collision {

struct EdgeOnEdge {
  Vector3d normal_b_to_a;              // unit
  std::array<Vector3d, 2> on_a, on_b;  // ends of the common segment, on either edge
};

/// Two edges along each other, closer than a millionth of `size`: the middle of their contact
/// normals, and the ends of their common segment.
/// @param n      a contact normal, unit, from B to A: within 90 degrees of the one returned
/// @param size   distance of the points from the origin of the query [m]
/// @return in the query's frame; nothing where no two edges lie along each other, or where they
///   have only one normal (flush boxes face on face)
/// Cost: one loop over all vertices; more only where an edge of each faces the other.
std::optional<EdgeOnEdge> edge_on_edge(const PlacedPolytope& a, const PlacedPolytope& b,
                                       const Vector3d& n, double size);

}  // namespace tumble::collision
