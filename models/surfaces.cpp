#include "models/surfaces.h"

#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/geometry/shape.h"

namespace tumble::models {
namespace {

bool is_pole(const Vector2d& r_z) { return r_z.x() == 0.0; }

}  // namespace

TriangleMesh box(const Vector3d& low, const Vector3d& high) {
  return moved(surface_of(Box{0.5 * (high - low)}), 0.5 * (low + high));
}

TriangleMesh extrude(const std::vector<Vector2d>& outline, const std::vector<Face>& triangles,
                     double z_low, double z_high) {
  const int n = static_cast<int>(outline.size());
  TriangleMesh mesh;
  for (double z : {z_low, z_high}) {
    for (const Vector2d& p : outline) mesh.vertices.push_back({p.x(), p.y(), z});
  }
  for (const auto& [a, b, c] : triangles) {
    mesh.faces.push_back({a, c, b});
    mesh.faces.push_back({n + a, n + b, n + c});
  }
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    mesh.faces.push_back({i, next, n + next});
    mesh.faces.push_back({i, n + next, n + i});
  }
  return mesh;
}

TriangleMesh revolve(const std::vector<Vector2d>& profile, int segments, bool closed) {
  require(segments >= 3 && profile.size() >= 3, "revolve: at least 3 segments and 3 points");
  require(closed || (is_pole(profile.front()) && is_pole(profile.back())),
          "revolve: an open profile starts and ends on the axis");
  TriangleMesh mesh;
  const int rows = static_cast<int>(profile.size());
  // vertex of each row; a pole has one, a ring has one a segment
  std::vector<int> first(profile.size());
  for (int row = 0; row < rows; ++row) {
    const Vector2d& p = profile[row];
    first[row] = static_cast<int>(mesh.vertices.size());
    for (int s = 0; s < (is_pole(p) ? 1 : segments); ++s) {
      const double angle = 2.0 * std::numbers::pi * s / segments;
      mesh.vertices.push_back({p.x() * std::cos(angle), p.x() * std::sin(angle), p.y()});
    }
  }
  const auto vertex = [&](int row, int s) {
    return first[row] + (is_pole(profile[row]) ? 0 : s % segments);
  };
  for (int row = 0; row + 1 < rows + (closed ? 1 : 0); ++row) {
    const int above = (row + 1) % rows;
    for (int s = 0; s < segments; ++s) {
      const int a = vertex(row, s), b = vertex(row, s + 1), c = vertex(above, s + 1),
                d = vertex(above, s);
      if (!is_pole(profile[row])) mesh.faces.push_back({a, b, c});
      if (!is_pole(profile[above])) mesh.faces.push_back({a, c, d});
    }
  }
  return mesh;
}

TriangleMesh star_shaped(const std::function<double(const Vector3d&)>& radius, int subdivisions) {
  TriangleMesh mesh = subdivided_sphere(subdivisions);
  for (Vector3d& vertex : mesh.vertices) vertex *= radius(vertex);
  return mesh;
}

TriangleMesh convex_hull(const std::vector<Vector3d>& points) {
  const int n = static_cast<int>(points.size());
  TriangleMesh mesh{points, {}};
  const auto all_below = [&](int i, int j, int k) {
    const Vector3d normal = (points[j] - points[i]).cross(points[k] - points[i]);
    for (int p = 0; p < n; ++p) {
      if (p != i && p != j && p != k && normal.dot(points[p] - points[i]) >= 0.0) return false;
    }
    return true;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      for (int k = j + 1; k < n; ++k) {
        if (all_below(i, j, k))
          mesh.faces.push_back({i, j, k});
        else if (all_below(i, k, j))
          mesh.faces.push_back({i, k, j});
      }
    }
  }
  // Points inside are left out.
  std::vector<int> number(points.size(), -1);
  TriangleMesh hull;
  for (Face& face : mesh.faces) {
    for (int& v : face) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(hull.vertices.size());
        hull.vertices.push_back(points[v]);
      }
      v = number[v];
    }
    hull.faces.push_back(face);
  }
  return hull;
}

TriangleMesh moved(TriangleMesh mesh, const Vector3d& by) {
  for (Vector3d& vertex : mesh.vertices) vertex += by;
  return mesh;
}

TriangleMesh turned(TriangleMesh mesh, const Quaterniond& by) {
  for (Vector3d& vertex : mesh.vertices) vertex = by * vertex;
  return mesh;
}

TriangleMesh rounded(TriangleMesh mesh) {
  for (Vector3d& vertex : mesh.vertices) vertex = vertex.cast<float>().cast<double>();
  return mesh;
}

}  // namespace tumble::models
