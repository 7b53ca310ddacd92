/// Closed surfaces by construction: what the models are made of. Faces run counter-clockwise seen
/// from outside.
#pragma once

#include <functional>
#include <vector>

#include "framework/core/math.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble::models {

/// A box with two opposite corners. [m]
TriangleMesh box(const Vector3d& low, const Vector3d& high);

/// A polygon in the xy plane, stretched along z.
/// @param outline    counter-clockwise, seen from above [m]
/// @param triangles  a triangulation of it, counter-clockwise
TriangleMesh extrude(const std::vector<Vector2d>& outline, const std::vector<Face>& triangles,
                     double z_low, double z_high);

/// A surface round the z axis.
/// @param profile   (r, z) from the bottom to the top [m]; where r is 0 the surface closes in one
///   vertex
/// @param closed    the profile's end meets its start (a torus); else it starts and ends at r = 0
/// @param segments  round the axis, at least 3
TriangleMesh revolve(const std::vector<Vector2d>& profile, int segments, bool closed = false);

/// A surface seen whole from the origin: an icosahedron, subdivided, each vertex moved to its
/// distance.
/// @param radius        of a unit direction [m]
/// @param subdivisions  20 * 4^n faces
TriangleMesh star_shaped(const std::function<double(const Vector3d&)>& radius, int subdivisions);

/// The convex hull of points in general position (no four in a plane), by trying every triple.
/// Cost: O(n^4)
TriangleMesh convex_hull(const std::vector<Vector3d>& points);

/// The same surface elsewhere.
TriangleMesh moved(TriangleMesh mesh, const Vector3d& by);
TriangleMesh turned(TriangleMesh mesh, const Quaterniond& by);

/// Coordinates as a float32 file will hold them.
TriangleMesh rounded(TriangleMesh mesh);

}  // namespace tumble::models
