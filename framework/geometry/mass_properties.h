/// Volume, centre of mass and inertia of the solid bounded by a closed surface.
#pragma once

#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// Mass properties of a solid of uniform density, in the frame of its mesh.
struct MassProperties {
  double volume = kUnset;  // [m^3]; negative where the faces are oriented inward
  double mass = kUnset;    // [kg] density * volume
  // (3), centre of mass, mesh frame [m]
  Vector3d com_mesh{kUnset, kUnset, kUnset};
  // (3, 3), about the centre of mass, mesh axes [kg m^2]
  Matrix3d inertia_com_mesh = Matrix3d::Constant(kUnset);
  Vector3d principal_moments{kUnset, kUnset, kUnset};  // (3), ascending [kg m^2]
  // columns are the axes of the moments above: a rotation (det +1)
  Matrix3d mesh_from_principal = Matrix3d::Constant(kUnset);
};

/// Volume, mass, centre of mass, inertia about it, principal moments and axes of the solid inside a
/// closed surface.
///   V = sum d / 6,   int x = sum d (a + b + c) / 24,
///       int x x' = sum d (a a' + b b' + c c' + s s') / 120
/// over the tetrahedra (0, a, b, c) under the faces, d = a . ((b - a) x (c - a)), s = a + b + c.
/// The origin is first moved into the solid, so that a solid far from the mesh's origin loses no
/// digits.
/// @param mesh     closed, oriented surface (geometry/closed.h); faces of zero area add nothing
/// @param density  > 0 [kg/m^3]
/// @return moments in ascending order; the largest component of the first and of the second axis is
///   positive, and the third axis is first x second. Where two moments are equal to round-off, the
///   axes in their plane are arbitrary, but repeatable.
/// @throws PreconditionError when the volume is zero or something is not finite
/// Source: B. Mirtich, J. Graphics Tools 1(2), 1996; S. Lien and J. Kajiya, IEEE CG&A 4(10), 1984.
/// Cost: O(faces)
MassProperties compute_mass_properties(const TriangleMesh& mesh, double density = 1.0);

/// Volume that a closed surface encloses, negative where its faces are oriented inward; meaningless
/// for an open surface. [m^3]
double signed_volume(const TriangleMesh& mesh);

/// Smallest and largest coordinates of the vertices. [m]
struct Bounds {
  Vector3d low, high;
};
/// @pre the mesh has a vertex
Bounds bounds_of(const TriangleMesh& mesh);

}  // namespace tumble
