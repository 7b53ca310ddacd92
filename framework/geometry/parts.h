/// The connected parts of a closed surface: which is a solid, which a cavity, and whether each is
/// oriented correctly.
#pragma once

#include <string>
#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/mesh_edges.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// The same surface with a separate vertex for every fan of faces: two cones that touch at their
/// tips are separated there. Unused vertices are dropped; the order is kept.
/// @param uses  of mesh, every edge in exactly two faces
TriangleMesh double_pinched_vertices(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses,
                                     std::vector<std::string>& notices);

/// Reverses the faces of inverted parts; finds parts without volume, and parts inside others that
/// are not cavities.
/// @param part_of_face  (faces), each part named by its smallest face
/// @param mesh          closed; its faces are reversed in place
std::vector<Defect> orient_parts(const std::vector<int>& part_of_face, TriangleMesh& mesh,
                                 std::vector<std::string>& notices);

/// How often the surface winds round a point: 1 inside, 0 outside, 1/2 on a smooth point of the
/// surface.
/// Source: A. Jacobson, L. Kavan, O. Sorkine-Hornung, ACM TOG 32(4), 2013 (solid angle: Van
/// Oosterom and Strackee, 1983).
double winding_number(const TriangleMesh& mesh, const Vector3d& point);

}  // namespace tumble
