#include "tests/collision/brute_force.h"

#include <algorithm>
#include <cmath>

namespace tumble::testing {
namespace {

/// Source: C. Ericson, Real-Time Collision Detection, 2005, sec. 5.1.5, without its Voronoi
/// regions: the projection onto the plane where it is inside the triangle, else the nearest of the
/// three sides.
double point_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (p - a - t * ab).norm();
}

double segment_to_segment(const Vector3d& p, const Vector3d& q, const Vector3d& r,
                          const Vector3d& s) {
  double nearest = std::min({point_to_segment(p, r, s), point_to_segment(q, r, s),
                             point_to_segment(r, p, q), point_to_segment(s, p, q)});
  const Vector3d u = q - p, v = s - r, w = p - r;
  const double a = u.dot(u), b = u.dot(v), c = v.dot(v), d = u.dot(w), e = v.dot(w),
               determinant = a * c - b * b;
  if (determinant > 1e-12 * a * c) {
    const double t = (b * e - c * d) / determinant, k = (a * e - b * d) / determinant;
    if (t >= 0 && t <= 1 && k >= 0 && k <= 1)
      nearest = std::min(nearest, (w + t * u - k * v).norm());
  }
  return nearest;
}

bool segment_crosses(const Vector3d& p, const Vector3d& q, const Triangle3& t) {
  const auto volume = [](const Vector3d& a, const Vector3d& b, const Vector3d& c,
                         const Vector3d& d) { return (b - a).cross(c - a).dot(d - a); };
  if ((volume(t[0], t[1], t[2], p) > 0) == (volume(t[0], t[1], t[2], q) > 0)) return false;
  const bool s0 = volume(p, q, t[0], t[1]) > 0, s1 = volume(p, q, t[1], t[2]) > 0,
             s2 = volume(p, q, t[2], t[0]) > 0;
  return s0 == s1 && s1 == s2;
}

}  // namespace

bool inside(const Vector3d& p, const Surface& surface) {
  const Vector3d far = p + Vector3d(97.3, 41.7, 63.1);  // not in a plane of any model
  return std::count_if(surface.begin(), surface.end(),
                       [&](const Triangle3& t) { return segment_crosses(p, far, t); }) %
             2 ==
         1;
}

double point_to_triangle(const Vector3d& p, const Triangle3& t) {
  const Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]);
  bool over = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vector3d& a = t[i];
    const Vector3d& b = t[(i + 1) % 3];
    over = over && n.dot((b - a).cross(p - a)) >= 0;
    nearest = std::min(nearest, point_to_segment(p, a, b));
  }
  return over ? std::abs(n.dot(p - t[0])) / n.norm() : nearest;
}

Surface placed(const TriangleMesh& mesh, const collision::Pose& pose) {
  Surface surface;
  for (const Face& face : mesh.faces) {
    Triangle3 t;
    for (int i = 0; i < 3; ++i)
      t[i] = pose.com_world + pose.world_from_body * mesh.vertices[face[i]];
    surface.push_back(t);
  }
  return surface;
}

BruteForce brute_force(const Surface& a, const Surface& b) {
  BruteForce found;
  for (const Triangle3& s : a) {
    for (const Triangle3& t : b) {
      for (int i = 0; i < 3; ++i) {
        found.distance =
            std::min({found.distance, point_to_triangle(s[i], t), point_to_triangle(t[i], s)});
        found.cross = found.cross || segment_crosses(s[i], s[(i + 1) % 3], t) ||
                      segment_crosses(t[i], t[(i + 1) % 3], s);
        for (int j = 0; j < 3; ++j)
          found.distance = std::min(found.distance,
                                    segment_to_segment(s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]));
      }
    }
  }
  found.one_in_other = inside(a[0][0], b) || inside(b[0][0], a);
  return found;
}

}  // namespace tumble::testing
