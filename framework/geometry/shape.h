/// The solids that bodies are made of. All in the body frame: origin at the centre of mass, axes of
/// the mesh.
#pragma once

#include <variant>

#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// Ball about the origin. Radius 0 is a point mass.
struct Sphere {
  double radius;  // [m], >= 0
};

/// Box about the origin, edges along the body's axes.
struct Box {
  Vector3d half_extents_body;  // (3), > 0 [m]
};

/// Ellipsoid with its axes along the body's axes. Its centre need not be the centre of mass (a
/// rattleback is the lower part of an ellipsoid).
/// It collides with half-spaces only.
struct Ellipsoid {
  Vector3d semi_axes_body;                  // (3), > 0 [m]
  Vector3d center_body = Vector3d::Zero();  // (3) [m]
};

/// Everything at or below z = 0 of the body frame: an infinite, immovable floor or wall with normal
/// +z.
struct HalfSpace {};

/// Solid bounded by a closed, outward-oriented surface.
struct MeshSolid {
  TriangleMesh mesh_body;  // [m], origin at the centre of mass
  bool is_convex;          // decided once, when the model is read
};

using Shape = std::variant<Sphere, Box, HalfSpace, MeshSolid, Ellipsoid>;

/// The shape's surface as triangles, for drawing and picking; a half-space becomes a square of side
/// 2 * extent about the origin.
/// @param extent  [m]; only for a half-space
TriangleMesh surface_of(const Shape& shape, double extent = 50.0);

/// Unit sphere from an icosahedron whose faces are repeatedly cut in four: 20 * 4^subdivisions
/// faces, vertices on the sphere.
/// @param subdivisions  >= 0
TriangleMesh subdivided_sphere(int subdivisions);

/// Radius of the smallest ball about the body's origin that contains the shape; an upper bound for
/// an ellipsoid off the origin, infinite for a half-space. [m]
double bounding_radius(const Shape& shape);

}  // namespace tumble
