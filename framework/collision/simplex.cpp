#include "framework/collision/simplex.h"

#include <limits>

namespace tumble::collision {
namespace {

Vector3d weighted(const Simplex& simplex) {
  Vector3d point = Vector3d::Zero();
  for (int i = 0; i < simplex.size; ++i) point += simplex.weights[i] * simplex.points[i].difference;
  return point;
}

Simplex pick(const Simplex& from, std::array<int, 3> indices, std::array<double, 3> weights, int size) {
  Simplex part;
  part.size = size;
  for (int i = 0; i < size; ++i) {
    part.points[i] = from.points[indices[i]];
    part.weights[i] = weights[i];
  }
  return part;
}

Simplex nearest_on_segment(const Simplex& s, int i, int j) {
  const Vector3d& a = s.points[i].difference;
  const Vector3d& b = s.points[j].difference;
  const Vector3d ab = b - a;
  const double t = -a.dot(ab), length_squared = ab.squaredNorm();
  if (!(t > 0)) return pick(s, {i}, {1.0}, 1);
  if (t >= length_squared) return pick(s, {j}, {1.0}, 1);
  return pick(s, {i, j}, {1.0 - t / length_squared, t / length_squared}, 2);
}

// Ericson 5.1.5 with the query point at the origin: by the Voronoi regions of corners, then edges, then the face.
Simplex nearest_on_triangle(const Simplex& s, int i, int j, int k) {
  const Vector3d& a = s.points[i].difference;
  const Vector3d& b = s.points[j].difference;
  const Vector3d& c = s.points[k].difference;
  const Vector3d ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a), d3 = -ab.dot(b), d4 = -ac.dot(b), d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d1 <= 0 && d2 <= 0) return pick(s, {i}, {1.0}, 1);
  if (d3 >= 0 && d4 <= d3) return pick(s, {j}, {1.0}, 1);
  if (d6 >= 0 && d5 <= d6) return pick(s, {k}, {1.0}, 1);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return nearest_on_segment(s, i, j);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return nearest_on_segment(s, i, k);
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return nearest_on_segment(s, j, k);
  const double sum = va + vb + vc;
  if (!(sum > 0)) return nearest_on_segment(s, i, j);  // a sliver: its face adds nothing to its edges
  return pick(s, {i, j, k}, {va / sum, vb / sum, vc / sum}, 3);
}

// The nearest point lies on a face that the origin is outside of; where there is none, the origin is inside.
bool nearest_on_tetrahedron(const Simplex& s, Simplex& best) {
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
  double best_distance = std::numeric_limits<double>::infinity();
  bool outside_any = false;
  for (const auto& f : kFaces) {
    const Vector3d& a = s.points[f[0]].difference;
    const Vector3d n = (s.points[f[1]].difference - a).cross(s.points[f[2]].difference - a);
    const double side_origin = -a.dot(n), side_fourth = (s.points[f[3]].difference - a).dot(n);
    if (side_origin * side_fourth > 0) continue;
    outside_any = true;
    const Simplex candidate = nearest_on_triangle(s, f[0], f[1], f[2]);
    const double distance = weighted(candidate).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return outside_any;
}

}  // namespace

Vector3d reduce_to_nearest(Simplex& simplex) {
  if (simplex.size == 1) {
    simplex.weights[0] = 1.0;
  } else if (simplex.size == 2) {
    simplex = nearest_on_segment(simplex, 0, 1);
  } else if (simplex.size == 3) {
    simplex = nearest_on_triangle(simplex, 0, 1, 2);
  } else {
    Simplex best;
    if (!nearest_on_tetrahedron(simplex, best)) return Vector3d::Zero();
    simplex = best;
  }
  return weighted(simplex);
}

}  // namespace tumble::collision
