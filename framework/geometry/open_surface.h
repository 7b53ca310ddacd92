/// Classifies the holes of an open surface in everyday words, with place and remedy.
#pragma once

#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/mesh_edges.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// Defects of a surface with open edges (edges of one face only); empty when it has none.
/// @param part_of_face  (faces), the part of each face, named by its smallest face
std::vector<Defect> describe_open_edges(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses,
                                        const std::vector<int>& part_of_face);

}  // namespace tumble
