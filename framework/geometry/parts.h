/// The connected pieces of a closed surface: which is outside, which a cavity, and whether each looks the right way.
#pragma once

#include <string>
#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/mesh_edges.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// The same surface with a vertex of its own for every fan of faces: two cones that touch at their tips part there.
/// Vertices that no face uses are dropped. Order is kept.
/// @param uses  of mesh, every edge in exactly two faces
TriangleMesh double_pinched_vertices(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses, std::vector<std::string>& notices);

/// Turns parts that are inside out; finds parts without volume and parts inside others that are not their cavities.
/// @param part_of_face  (faces), by the smallest face of each part
/// @param mesh          closed; its faces are turned in place
std::vector<Defect> orient_parts(const std::vector<int>& part_of_face, TriangleMesh& mesh, std::vector<std::string>& notices);

/// How often the surface winds round a point: 1 inside, 0 outside, 1/2 on a smooth place of the surface.
/// Source: A. Jacobson, L. Kavan, O. Sorkine-Hornung, ACM TOG 32(4), 2013 (solid angle: Van Oosterom and Strackee, 1983).
double winding_number(const TriangleMesh& mesh, const Vector3d& point);

}  // namespace tumble
