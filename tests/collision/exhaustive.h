/// The exhaustive method for a gap: every corner, edge and face of one convex solid against all of
/// the other, with 33 digits. Edges parallel to 1e-9 rad need them, because their cross product
/// loses nine digits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "framework/collision/collision_shape.h"

namespace tumble::testing {

__extension__ typedef __float128 Real;

constexpr double kFar = 1e300;

inline Real root(Real x) {
  if (!(x > 0)) return 0;
  Real y = std::sqrt(static_cast<double>(x));
  if (!(y > 0)) return 0;
  for (int i = 0; i < 2; ++i) y = (y + x / y) / 2;  // digits double each time
  return y;
}
inline Real magnitude(Real x) { return x < 0 ? -x : x; }

struct Exact {
  Real x = 0, y = 0, z = 0;

  static Exact of(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
  Real dot(const Exact& o) const { return x * o.x + y * o.y + z * o.z; }
  Exact cross(const Exact& o) const {
    return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x};
  }
  Real squared() const { return dot(*this); }
  Real norm() const { return root(squared()); }
  friend Exact operator+(const Exact& a, const Exact& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Exact operator-(const Exact& a, const Exact& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend Exact operator*(Real k, const Exact& a) { return {k * a.x, k * a.y, k * a.z}; }
};

/// A convex surface in its pose.
struct PlacedSurface {
  std::vector<Exact> vertices;
  std::vector<std::array<int, 3>> faces;
};

inline PlacedSurface placed_exactly(const TriangleMesh& mesh, const collision::Pose& pose,
                                    const Vector3d& origin) {
  // rounded like the solid's own
  const Matrix3d rotation = pose.world_from_body.toRotationMatrix();
  const Exact offset = Exact::of(pose.com_world) - Exact::of(origin);
  PlacedSurface surface;
  for (const Vector3d& v : mesh.vertices)
    surface.vertices.push_back(Exact{Exact::of(rotation.row(0)).dot(Exact::of(v)),
                                     Exact::of(rotation.row(1)).dot(Exact::of(v)),
                                     Exact::of(rotation.row(2)).dot(Exact::of(v))} +
                               offset);
  for (const Face& f : mesh.faces)
    surface.faces.push_back(
        {static_cast<int>(f[0]), static_cast<int>(f[1]), static_cast<int>(f[2])});
  return surface;
}

inline Real exact_point_to_segment(const Exact& p, const Exact& a, const Exact& b) {
  const Exact ab = b - a;
  const Real t = std::clamp<Real>((p - a).dot(ab) / ab.squared(), 0, 1);
  return (p - a - t * ab).norm();
}

inline Real exact_point_to_triangle(const Exact& p, const Exact& a, const Exact& b,
                                    const Exact& c) {
  const Exact n = (b - a).cross(c - a);
  const bool over = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                    n.dot((a - c).cross(p - c)) >= 0;
  if (over) return magnitude(n.dot(p - a)) / n.norm();
  return std::min({exact_point_to_segment(p, a, b), exact_point_to_segment(p, b, c),
                   exact_point_to_segment(p, c, a)});
}

/// Only for nearest points inside both segments: beyond an end the distance is that of a corner.
inline Real exact_line_to_line(const Exact& p, const Exact& q, const Exact& r, const Exact& s) {
  const Exact u = q - p, v = s - r, w = p - r, n = u.cross(v);
  const Real squared = n.squared();
  if (!(squared > 0)) return kFar;
  const Real t = v.cross(w).dot(n) / squared, k = u.cross(w).dot(n) / squared;
  if (t < 0 || t > 1 || k < 0 || k > 1) return kFar;
  return magnitude(n.dot(w)) / root(squared);
}

/// Largest separation over all normals of faces and products of edges: <= 0 exactly where the two
/// overlap or touch.
inline Real exact_separation(const PlacedSurface& a, const PlacedSurface& b) {
  Real best = -kFar;
  const auto offer = [&](const Exact& across) {
    const Real length = across.norm();
    if (!(length > 0)) return;
    Real low_a = kFar, high_a = -low_a, low_b = low_a, high_b = -low_a;
    for (const Exact& v : a.vertices) {
      low_a = std::min(low_a, across.dot(v));
      high_a = std::max(high_a, across.dot(v));
    }
    for (const Exact& v : b.vertices) {
      low_b = std::min(low_b, across.dot(v));
      high_b = std::max(high_b, across.dot(v));
    }
    best = std::max(best, std::max(low_a - high_b, low_b - high_a) / length);
  };
  std::array<std::vector<Exact>, 2> edges;
  for (const int which : {0, 1}) {
    const PlacedSurface& s = which == 0 ? a : b;
    for (const auto& f : s.faces) {
      offer((s.vertices[f[1]] - s.vertices[f[0]]).cross(s.vertices[f[2]] - s.vertices[f[0]]));
      for (int i = 0; i < 3; ++i)
        if (f[i] < f[(i + 1) % 3]) {
          const Exact edge = s.vertices[f[(i + 1) % 3]] - s.vertices[f[i]];
          edges[which].push_back((1 / edge.norm()) * edge);
        }
    }
  }
  const Real kParallel = 1e-20;  // rad: the cross product has thirteen digits left
  for (const Exact& u : edges[0])
    for (const Exact& v : edges[1])
      if (const Exact across = u.cross(v); across.norm() > kParallel) offer(across);
  return best;
}

/// Distance of two convex solids; where they touch or overlap, the negative penetration depth.
inline Real exact_gap(const PlacedSurface& a, const PlacedSurface& b) {
  const Real separation = exact_separation(a, b);
  if (!(separation > 0)) return separation;
  Real distance = kFar;
  const auto corners_to_faces = [&](const PlacedSurface& s, const PlacedSurface& t) {
    for (const Exact& p : s.vertices)
      for (const auto& f : t.faces)
        distance = std::min(distance, exact_point_to_triangle(p, t.vertices[f[0]], t.vertices[f[1]],
                                                              t.vertices[f[2]]));
  };
  corners_to_faces(a, b);
  corners_to_faces(b, a);
  for (const auto& f : a.faces)
    for (const auto& g : b.faces)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          if (f[i] < f[(i + 1) % 3] && g[j] < g[(j + 1) % 3])
            distance = std::min(distance,
                                exact_line_to_line(a.vertices[f[i]], a.vertices[f[(i + 1) % 3]],
                                                   b.vertices[g[j]], b.vertices[g[(j + 1) % 3]]));
  return distance;
}

}  // namespace tumble::testing
