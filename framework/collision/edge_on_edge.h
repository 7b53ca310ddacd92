/// Which way two solids push each other where an edge of one lies along an edge of the other. Internal to collision.
///
/// Two such edges touch along a line, and every direction that both normal cones hold is a normal of theirs: the direction between the
/// nearest points is no more than rounding, or the shell they are kept apart by. A force may act along any of them; for one answer that
/// does not hang on the last digit, and that a mirror turns into its mirror image, the middle one is taken.
///
///   n in cone(B's edge), -n in cone(A's edge):  angles about the edge in [low, high];  normal at (low + high) / 2
#pragma once

#include <array>
#include <optional>

#include "framework/collision/polytope.h"

namespace tumble::collision {

struct EdgeOnEdge {
  Vector3d normal_b_to_a;                    // unit
  std::array<Vector3d, 2> on_a, on_b;        // where the stretch that both cover begins and ends, on either edge
};

/// Two edges that lie along each other, nearer than a millionth of `size`: the middle of their normals, and the ends of what they share.
/// @param n      a normal of theirs, unit, from B to A: within 90 degrees of the one returned
/// @param size   how far the points lie from the origin of the query [m]
/// @return in the query's frame; nothing where no two edges do, or where they have one normal only (as flush boxes that lie face on face)
/// Cost: all vertices of both once, and more only where each faces the other with an edge.
std::optional<EdgeOnEdge> edge_on_edge(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n, double size);

}  // namespace tumble::collision
