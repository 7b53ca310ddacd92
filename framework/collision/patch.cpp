#include "framework/collision/patch.h"

#include <algorithm>
#include <cmath>

namespace tumble::collision {
namespace {

using Polygon = std::vector<Vector2d>;

double cross2(const Vector2d& u, const Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); }

// Axes of the plane across n. The one of the world's axes that lies flattest on it starts them, so that they do not jump.
struct PlaneAxes {
  Vector3d u, v;
  explicit PlaneAxes(const Vector3d& n) {
    int flattest = 0;
    n.cwiseAbs().minCoeff(&flattest);
    u = n.cross(Vector3d::Unit(flattest)).normalized();
    v = n.cross(u);
  }
  Vector2d flatten(const Vector3d& p) const { return {u.dot(p), v.dot(p)}; }
};

// Monotone chain, counter-clockwise; points that coincide to round-off count once.
Polygon hull_of(Polygon points) {
  std::sort(points.begin(), points.end(), [](const Vector2d& a, const Vector2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  double size = 0.0;
  for (const Vector2d& p : points) size = std::max(size, (p - points[0]).norm());
  const double same = 1e-12 * size;
  Polygon distinct;
  for (const Vector2d& p : points) {
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const Vector2d& q) { return (p - q).norm() <= same; });
    if (!known) distinct.push_back(p);
  }
  if (distinct.size() < 3) return distinct;
  Polygon hull;
  const auto grow = [&](const Vector2d& p, std::size_t base) {
    while (hull.size() >= base + 2 && cross2(hull.back() - hull[hull.size() - 2], p - hull.back()) <= same * size) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vector2d& p : distinct) grow(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto p = distinct.rbegin() + 1; p != distinct.rend(); ++p) grow(*p, lower);
  hull.pop_back();
  return hull;
}

Polygon crossing_of_segments(const Polygon& a, const Polygon& b) {
  const Vector2d along_a = a[1] - a[0], along_b = b[1] - b[0];
  const double across = cross2(along_a, along_b);
  if (std::abs(across) > 1e-9 * along_a.norm() * along_b.norm()) {
    const double t = std::clamp(cross2(b[0] - a[0], along_b) / across, 0.0, 1.0);
    return {a[0] + t * along_a};
  }
  // Side by side: the stretch that both cover.
  const double length = along_a.squaredNorm();
  const double first = along_a.dot(b[0] - a[0]) / length, second = along_a.dot(b[1] - a[0]) / length;
  const double low = std::clamp(std::min(first, second), 0.0, 1.0), high = std::clamp(std::max(first, second), 0.0, 1.0);
  return {a[0] + low * along_a, a[0] + high * along_a};
}

// I. Sutherland, G. Hodgman, Reentrant polygon clipping, CACM 17 (1974) 32.
Polygon clip(Polygon subject, const Polygon& window) {
  for (std::size_t i = 0; i < window.size() && !subject.empty(); ++i) {
    const Vector2d& p = window[i];
    const Vector2d edge = window[(i + 1) % window.size()] - p;
    const auto side = [&](const Vector2d& q) { return cross2(edge, q - p); };
    Polygon kept;
    for (std::size_t k = 0; k < subject.size(); ++k) {
      const Vector2d &q = subject[k], &next = subject[(k + 1) % subject.size()];
      const double s = side(q), s_next = side(next);
      if (s >= 0) kept.push_back(q);
      if ((s > 0 && s_next < 0) || (s < 0 && s_next > 0)) kept.push_back(q + (s / (s - s_next)) * (next - q));
    }
    subject = std::move(kept);
  }
  return subject;
}

Polygon shared_region(Polygon a, Polygon b) {
  if (a.size() > b.size()) std::swap(a, b);
  if (a.size() == 1) return a;
  if (b.size() == 2) return crossing_of_segments(a, b);
  const Polygon region = clip(a, b);
  if (!region.empty()) return region;
  Vector2d middle = Vector2d::Zero();  // they only touch at a rim, and rounding parts them
  for (const Vector2d& p : a) middle += p / static_cast<double>(a.size());
  return {middle};
}

}  // namespace

std::vector<Vector3d> facing_region(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n, double tolerance) {
  const PlaneAxes axes(n);
  const auto facing = [&](const std::vector<Vector3d>& vertices, double side) {
    double foremost = side * n.dot(vertices[0]);
    for (const Vector3d& v : vertices) foremost = std::min(foremost, side * n.dot(v));
    Polygon points;
    for (const Vector3d& v : vertices)
      if (side * n.dot(v) <= foremost + tolerance) points.push_back(axes.flatten(v));
    return std::pair(hull_of(std::move(points)), side * foremost);
  };
  const auto [facing_a, height] = facing(a.vertices, 1.0);
  std::vector<Vector3d> corners;
  for (const Vector2d& p : shared_region(facing_a, facing(b.vertices, -1.0).first)) corners.push_back(p.x() * axes.u + p.y() * axes.v + height * n);
  return corners;
}

FlatHull flat_hull(const std::vector<Vector3d>& points, const Vector3d& n) {
  const PlaneAxes axes(n);
  Polygon flat;
  for (const Vector3d& p : points) flat.push_back(axes.flatten(p - points[0]));
  const Polygon hull = hull_of(std::move(flat));
  const auto lift = [&](const Vector2d& p) -> Vector3d { return points[0] + p.x() * axes.u + p.y() * axes.v; };
  FlatHull result;
  Vector2d middle = Vector2d::Zero();
  double area = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    result.corners.push_back(lift(hull[i]));
    const Vector2d &p = hull[i], &q = hull[(i + 1) % hull.size()];
    area += cross2(p, q);
    middle += cross2(p, q) * (p + q) / 3.0;
  }
  if (hull.size() >= 3 && area > 0) {
    middle /= area;
  } else {
    middle.setZero();
    for (const Vector2d& p : hull) middle += p / static_cast<double>(hull.size());
  }
  result.middle = lift(middle);
  return result;
}

}  // namespace tumble::collision
