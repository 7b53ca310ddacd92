/// Convex rocks with a given number of vertices, for tests and figures.
#pragma once

#include <random>
#include <vector>

#include "framework/geometry/shape.h"

namespace tumble::testing {

/// The hull of points in general position, by testing every triple. Cost: O(n^4).
inline TriangleMesh hull_mesh(const std::vector<Vector3d>& points) {
  TriangleMesh mesh;
  mesh.vertices = points;
  const int n = static_cast<int>(points.size());
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        const Vector3d across = (points[j] - points[i]).cross(points[k] - points[i]);
        int above = 0, below = 0;
        for (int m = 0; m < n; ++m) {
          if (m == i || m == j || m == k) continue;
          ++(across.dot(points[m] - points[i]) > 0 ? above : below);
        }
        if (above == 0) mesh.faces.push_back({i, j, k});
        if (below == 0) mesh.faces.push_back({i, k, j});
      }
  return mesh;
}

/// A rock: `vertices` corners on an ellipsoid with semi-axes 0.5, 0.45 and 0.35 m. The same seed
/// gives the same rock.
inline Shape random_hull(int vertices, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> points;
  for (int i = 0; i < vertices; ++i) {
    const Vector3d direction =
        Vector3d(normal(random), normal(random), normal(random)).normalized();
    points.push_back(direction.cwiseProduct(Vector3d(0.5, 0.45, 0.35)));
  }
  return MeshSolid{hull_mesh(points), true};
}

}  // namespace tumble::testing
