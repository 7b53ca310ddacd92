/// Is a surface the boundary of a solid? If not: what is wrong, where, and how to repair it.
#pragma once

#include <string>
#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// What check_closed found.
struct ClosedReport {
  std::vector<Defect> defects;       // none: the surface is closed
  std::vector<std::string> notices;  // repairs, and what is unusual but legal
  // the repaired surface: no unused vertices, outward; the input where defects remain
  TriangleMesh mesh;
  int parts = 0;  // connected components, cavities included
  bool is_closed() const { return defects.empty(); }
};

/// Whether a mesh is a closed, orientable manifold that bounds a volume; every defect with its
/// place.
/// A surface may have several parts, which may touch, and cavities. Parts that pass through each
/// other are refused by name (crossings.h).
/// Repaired with a notice: the faces of an inverted part are reversed; degenerate faces are dropped
/// where they keep the surface from being closed; duplicate faces, and pairs of faces back to back,
/// are dropped where the rest is a solid; a vertex at which two fans of faces touch is doubled;
/// unused vertices are dropped.
/// @param mesh  equal positions already share a vertex (geometry/load_3ds.h welds)
/// @post  when is_closed(): report.mesh has every edge in exactly two faces, once in each
///        direction, and positive volume
/// Cost: O(n log n) in the faces, plus O(k n) for k parts inside each other's bounding boxes.
ClosedReport check_closed(const TriangleMesh& mesh);

}  // namespace tumble
