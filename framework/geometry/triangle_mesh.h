/// A surface as triangles. Other files check that it is closed, and compute mass properties and
/// intersections with rays.
#pragma once

#include <array>
#include <vector>

#include "framework/core/math.h"

namespace tumble {

/// Corners of a face as indices into the vertices, counter-clockwise seen from outside.
using Face = std::array<int, 3>;

struct TriangleMesh {
  std::vector<Vector3d> vertices;  // [m], in the mesh or body frame, as the member's name says
  std::vector<Face> faces;
};

}  // namespace tumble
