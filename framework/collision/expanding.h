/// Penetration depth of two convex polytopes: the expanding polytope algorithm (EPA) on their
/// Minkowski difference A - B. Internal to collision.
/// Source: G. van den Bergen, Proximity Queries and Penetration Depth Computation on 3D Game
/// Objects, GDC 2001.
#pragma once

#include <optional>

#include "framework/collision/axes.h"
#include "framework/collision/gjk.h"

namespace tumble::collision {

/// The face of A - B that is nearest to the origin inside; where the origin is outside by a few
/// roundings, a face that it lies in front of.
/// @param start  the last simplex of the GJK algorithm
/// @return the separation to a few roundings of `size`, the normal less accurately; nothing where A
///   - B is flat or has too many faces
std::optional<Axis> expand(const PlacedPolytope& a, const PlacedPolytope& b, const Simplex& start,
                           double size);

}  // namespace tumble::collision
