/// Is a surface the boundary of a solid? Says what is wrong, where, and what to do about it.
#pragma once

#include <string>
#include <vector>

#include "framework/geometry/defect.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// What check_closed found.
struct ClosedReport {
  std::vector<Defect> defects;       // none: the surface is closed
  std::vector<std::string> notices;  // what was repaired, or is odd but legal
  TriangleMesh mesh;                 // the surface as repaired: no unused vertices, outward; as given where defects remain
  int parts = 0;                     // connected pieces; cavities count
  bool is_closed() const { return defects.empty(); }
};

/// Whether a mesh is a closed, orientable manifold that bounds a volume; every defect with its place.
/// Several parts and cavities are legal; parts that touch are, and parts that pass through each other are refused by name (crossings.h).
/// Repaired with a notice: a part that is inside out is turned; faces of zero area that stand in the way are dropped, and so is a face
/// that is there twice; two that lie back to back go where the rest is a solid without them; a vertex at which two fans of faces touch
/// is doubled; unused vertices are dropped.
/// @param mesh  equal positions already share a vertex (geometry/load_3ds.h welds)
/// @post  when is_closed(): report.mesh has every edge in exactly two faces, once in each direction, and positive volume
/// Cost: O(n log n) in the faces, plus O(k n) for k parts inside each other's bounding boxes.
ClosedReport check_closed(const TriangleMesh& mesh);

}  // namespace tumble
