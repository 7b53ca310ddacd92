#include "framework/collision/simplex.h"

#include <limits>

namespace tumble::collision {
namespace {

// The face of a simplex that contains its nearest point.
struct Part {
  int size;
  std::array<int, 3> at;
  std::array<double, 3> weights;
  Vector3d point;
};

Part corner(const Simplex& s, int i) {
  return {1, {i, 0, 0}, {1.0, 0.0, 0.0}, s.points[i].difference};
}

Part nearest_on_segment(const Simplex& s, int i, int j) {
  const Vector3d& a = s.points[i].difference;
  const Vector3d& b = s.points[j].difference;
  const Vector3d ab = b - a;
  const double t = -a.dot(ab), length_squared = ab.squaredNorm();
  if (!(t > 0)) return corner(s, i);
  if (t >= length_squared) return corner(s, j);
  const double v = t / length_squared, u = 1.0 - v;
  return {2, {i, j, 0}, {u, v, 0.0}, u * a + v * b};
}

// Ericson 5.1.5 with the query point at the origin: by the Voronoi regions of corners, then edges,
// then the face.
Part nearest_on_triangle(const Simplex& s, int i, int j, int k) {
  const Vector3d& a = s.points[i].difference;
  const Vector3d& b = s.points[j].difference;
  const Vector3d& c = s.points[k].difference;
  const Vector3d ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a), d3 = -ab.dot(b), d4 = -ac.dot(b), d5 = -ab.dot(c),
               d6 = -ac.dot(c);
  if (d1 <= 0 && d2 <= 0) return corner(s, i);
  if (d3 >= 0 && d4 <= d3) return corner(s, j);
  if (d6 >= 0 && d5 <= d6) return corner(s, k);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return nearest_on_segment(s, i, j);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return nearest_on_segment(s, i, k);
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return nearest_on_segment(s, j, k);
  const double sum = va + vb + vc;
  if (!(sum > 0)) return nearest_on_segment(s, i, j);  // a sliver: its edges cover it
  const double u = va / sum, v = vb / sum, w = vc / sum;
  return {3, {i, j, k}, {u, v, w}, u * a + v * b + w * c};
}

// The nearest point lies on a face with the origin on its outer side; where no face has, the origin
// is inside.
bool nearest_on_tetrahedron(const Simplex& s, Part& best) {
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
  double best_distance = std::numeric_limits<double>::infinity();
  bool outside_any = false;
  for (const auto& f : kFaces) {
    const Vector3d& a = s.points[f[0]].difference;
    const Vector3d n = (s.points[f[1]].difference - a).cross(s.points[f[2]].difference - a);
    const double side_origin = -a.dot(n), side_fourth = (s.points[f[3]].difference - a).dot(n);
    if (side_origin * side_fourth > 0) continue;
    outside_any = true;
    const Part candidate = nearest_on_triangle(s, f[0], f[1], f[2]);
    const double distance = candidate.point.squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return outside_any;
}

}  // namespace

Vector3d reduce_to_nearest(Simplex& simplex) {
  Part part;
  if (simplex.size == 1) {
    part = corner(simplex, 0);
  } else if (simplex.size == 2) {
    part = nearest_on_segment(simplex, 0, 1);
  } else if (simplex.size == 3) {
    part = nearest_on_triangle(simplex, 0, 1, 2);
  } else if (!nearest_on_tetrahedron(simplex, part)) {
    return Vector3d::Zero();
  }
  // The indices of a tetrahedron's face may not ascend: copy the points before they are
  // overwritten.
  const std::array<DifferencePoint, 3> kept{simplex.points[part.at[0]], simplex.points[part.at[1]],
                                            simplex.points[part.at[2]]};
  simplex.size = part.size;
  for (int i = 0; i < part.size; ++i) {
    simplex.points[i] = kept[i];
    simplex.weights[i] = part.weights[i];
  }
  return part.point;
}

}  // namespace tumble::collision
