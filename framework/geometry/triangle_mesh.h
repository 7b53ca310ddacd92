/// A surface as triangles. What is closed, what it weighs and where a ray meets it stand in files of their own.
#pragma once

#include <array>
#include <vector>

#include "framework/core/math.h"

namespace tumble {

/// Corners of a face as indices into the vertices, counter-clockwise seen from outside.
using Face = std::array<int, 3>;

struct TriangleMesh {
  std::vector<Vector3d> vertices;  // [m], frame as the holder says (mesh or body)
  std::vector<Face> faces;
};

}  // namespace tumble
