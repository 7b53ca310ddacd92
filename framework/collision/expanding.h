/// How deep two convex polytopes overlap: the expanding polytope algorithm on their difference A - B. Internal to collision.
/// Source: G. van den Bergen, Proximity Queries and Penetration Depth Computation on 3D Game Objects, GDC 2001.
#pragma once

#include <optional>

#include "framework/collision/axes.h"
#include "framework/collision/gjk.h"

namespace tumble::collision {

/// The face of A - B whose plane the origin lies least deep behind. Where the origin is outside by a few roundings, that of a face
/// that it lies before.
/// @param start  what the GJK algorithm ended with
/// @return to a few roundings of `size`, the normal less so; nothing where A - B is flat or has too many faces
std::optional<Axis> expand(const PlacedPolytope& a, const PlacedPolytope& b, const Simplex& start, double size);

}  // namespace tumble::collision
