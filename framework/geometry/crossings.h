/// Do shells of a surface pass through each other, or one through itself? A region inside two
/// shells would count twice in the volume.
#pragma once

#include <string>
#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// Defects of a closed, oriented surface whose faces cross: one for every pair of parts that cross
/// (also a part with itself); the first few are named. Parts that touch, at a corner, along an edge
/// or face on face, do not cross.
/// Two faces cross where the common line of their planes runs through the interiors of both over a
/// length above the rounding of float32 coordinates. Parts whose faces only lie on each other (two
/// boxes pushed into each other along an edge) are decided by winding numbers: a part crosses
/// another where some of its faces lie inside the other and some outside.
/// @param part_of_face  (faces), each part named by its smallest face
/// @param notices       gets a line where too many pairs of faces overlap to test them all
/// Cost: O(n log n) for a surface that is spread out; O(n m) for parts of n and m faces that lie on
/// each other Source: T. Moeller, "A fast triangle-triangle intersection test", J. Graphics Tools
/// 2(2), 1997 (intervals on the common line).
std::vector<Defect> find_crossings(const TriangleMesh& closed_mesh,
                                   const std::vector<int>& part_of_face,
                                   std::vector<std::string>& notices);

}  // namespace tumble
