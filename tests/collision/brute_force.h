/// The gap of two solids, convex or not, by all faces against all faces: closed forms for segments
/// and corners, and a count of crossings for points inside.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "framework/collision/collision_shape.h"

namespace tumble::testing {

using Triangle3 = std::array<Vector3d, 3>;
using Surface = std::vector<Triangle3>;

/// The mesh's faces where the pose puts them. [m]
Surface placed(const TriangleMesh& mesh, const collision::Pose& pose);

/// [m]
double point_to_triangle(const Vector3d& p, const Triangle3& t);

/// By a count of crossings on the way to a place far away.
bool inside(const Vector3d& p, const Surface& surface);

struct BruteForce {
  double distance = std::numeric_limits<double>::infinity();  ///< of the surfaces [m]
  bool cross = false;         ///< an edge of one goes through a face of the other
  bool one_in_other = false;  ///< a corner of one is inside the other
};

BruteForce brute_force(const Surface& a, const Surface& b);

}  // namespace tumble::testing
