/// What kind of hole does an open surface have? Names it as a person would, with its place and remedy.
#pragma once

#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/mesh_edges.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// Defects of a surface with open edges (used by one face only); empty when it has none.
/// @param part_of_face  (faces), the connected piece that each face belongs to, by the smallest face in it
std::vector<Defect> describe_open_edges(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses,
                                        const std::vector<int>& part_of_face);

}  // namespace tumble
