/// Do shells of a surface pass through each other, or one through itself? What lies inside twice would count twice in the volume.
#pragma once

#include <string>
#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// Defects of a closed, oriented surface whose faces cross: one for every pair of parts that cross (a part with itself too), the first
/// few named. Parts that touch, at a corner, along an edge or face on face, do not cross.
/// Two faces cross where the line that their planes share runs through the insides of both for longer than float32 coordinates are
/// rounded by. Parts whose faces only lie on each other (two boxes pushed into each other along an edge) are told by winding numbers:
/// a part of whose faces some lie inside the other and some outside crosses it.
/// @param part_of_face  (faces), by the smallest face of each part
/// @param notices       told where so many faces lie in each other's way that not all were looked at
/// Cost: O(n log n) for a surface that is spread out; O(n m) for parts of n and m faces that lie on each other
/// Source: T. Moeller, "A fast triangle-triangle intersection test", J. Graphics Tools 2(2), 1997 (intervals on the common line).
std::vector<Defect> find_crossings(const TriangleMesh& closed_mesh, const std::vector<int>& part_of_face, std::vector<std::string>& notices);

}  // namespace tumble
