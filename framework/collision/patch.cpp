#include "framework/collision/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace tumble::collision {
namespace {

struct FlatPoint {
  Vector2d p;
  int index;  // in the original list; -1: a new point
};
using Polygon = InlineVector<FlatPoint, 16>;
using PointHeights = InlineVector<double, 16>;

// Of the coordinates: what polygons that touch at their boundaries are apart by, first that of
// coordinates alone, then that of a normal that itself has rounding.
constexpr double kBoundarySlacks[] = {1e-14, 1e-12, 1e-9};

double cross2(const Vector2d& u, const Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); }

// Axes of the plane perpendicular to n, constructed from the world axis nearest to that plane, so
// that they change continuously with n.
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

bool comes_before(const FlatPoint& a, const FlatPoint& b) {
  if (a.p.x() != b.p.x()) return a.p.x() < b.p.x();
  return a.p.y() != b.p.y() ? a.p.y() < b.p.y() : a.index < b.index;
}

// Merges points that coincide to round-off.
Polygon distinct_of(const Polygon& sorted, double same) {
  Polygon distinct;
  for (const FlatPoint& q : sorted) {
    bool known = false;
    for (int k = distinct.size() - 1; k >= 0 && q.p.x() - distinct[k].p.x() <= same && !known; --k)
      known = (q.p - distinct[k].p).norm() <= same;
    if (!known) distinct.push_back(q);
  }
  return distinct;
}

// Monotone chain, counter-clockwise.
Polygon hull_of(Polygon points) {
  if (points.size() < 2) return points;
  std::sort(points.begin(), points.end(), comes_before);
  double size = 0.0;
  for (const FlatPoint& q : points) size = std::max(size, (q.p - points[0].p).norm());
  const double same = 1e-12 * size;
  const Polygon distinct = distinct_of(points, same);
  if (distinct.size() < 3) return distinct;
  // On an edge perpendicular to the sorting direction, rounding would decide the order, and the
  // edge's end could be lost to a point on the edge.
  Polygon ordered;
  double column = distinct[0].p.x();
  for (int i = 0; i < distinct.size(); ++i) {
    if (distinct[i].p.x() - column > same) column = distinct[i].p.x();
    ordered.push_back({{column, distinct[i].p.y()}, i});
  }
  std::sort(ordered.begin(), ordered.end(), comes_before);
  Polygon hull;
  const auto grow = [&](const FlatPoint& q, int base) {
    while (hull.size() >= base + 2 &&
           cross2(hull.back().p - hull[hull.size() - 2].p, q.p - hull.back().p) <= same * size)
      hull.shrink(hull.size() - 1);
    hull.push_back(q);
  };
  for (const FlatPoint& q : ordered) grow(q, 0);
  const int lower = hull.size() - 1;
  for (int k = ordered.size() - 2; k >= 0; --k) grow(ordered[k], lower);
  hull.shrink(hull.size() - 1);
  for (FlatPoint& q : hull) q = distinct[q.index];
  return hull;
}

Polygon crossing_of_segments(const Polygon& a, const Polygon& b) {
  const Vector2d along_a = a[1].p - a[0].p, along_b = b[1].p - b[0].p;
  const double across = cross2(along_a, along_b);
  Polygon crossing;
  if (std::abs(across) > 1e-9 * along_a.norm() * along_b.norm()) {
    const double t = std::clamp(cross2(b[0].p - a[0].p, along_b) / across, 0.0, 1.0);
    crossing.push_back({a[0].p + t * along_a, -1});
    return crossing;
  }
  // Parallel: the common segment.
  const double length = along_a.squaredNorm();
  const double first = along_a.dot(b[0].p - a[0].p) / length,
               second = along_a.dot(b[1].p - a[0].p) / length;
  const double low = std::clamp(std::min(first, second), 0.0, 1.0),
               high = std::clamp(std::max(first, second), 0.0, 1.0);
  crossing.push_back({a[0].p + low * along_a, -1});
  crossing.push_back({a[0].p + high * along_a, -1});
  return crossing;
}

// I. Sutherland, G. Hodgman, Reentrant polygon clipping, CACM 17 (1974) 32.
/// @param slack  [m] the window is wider by this on every side
Polygon clip(const Polygon& cut, const Polygon& window, double slack = 0.0) {
  Polygon subject = cut, kept;
  for (int i = 0; i < window.size() && !subject.empty(); ++i) {
    const Vector2d& p = window[i].p;
    const Vector2d edge = window[(i + 1) % window.size()].p - p;
    const double room = slack > 0 ? slack * edge.norm() : 0.0;
    const auto side = [&](const FlatPoint& q) { return cross2(edge, q.p - p) + room; };
    kept.clear();
    for (int k = 0; k < subject.size(); ++k) {
      const FlatPoint &q = subject[k], &next = subject[(k + 1) % subject.size()];
      const double s = side(q), s_next = side(next);
      if (s >= 0) kept.push_back(q);
      if ((s > 0 && s_next < 0) || (s < 0 && s_next > 0))
        kept.push_back({q.p + (s / (s - s_next)) * (next.p - q.p), -1});
    }
    std::swap(subject, kept);
  }
  return subject;
}

// Distance of a point from the nearest line along a side of the window; < 0: outside.
double room_in(const Polygon& window, const Vector2d& point) {
  double room = std::numeric_limits<double>::infinity();
  for (int i = 0; i < window.size(); ++i) {
    const Vector2d edge = window[(i + 1) % window.size()].p - window[i].p;
    room = std::min(room, cross2(edge, point - window[i].p) / edge.norm());
  }
  return room;
}

// `a` has at most as many corners as `b`.
Polygon shared_region(const Polygon& a, const Polygon& b) {
  if (a.size() == 1) return a;
  if (b.size() == 2) return crossing_of_segments(a, b);
  Polygon region = clip(a, b);
  if (!region.empty()) return region;
  // They touch only at their boundaries, and rounding separates them.
  double size = 0.0;
  for (const Polygon* polygon : {&a, &b})
    for (const FlatPoint& q : *polygon) size = std::max(size, q.p.cwiseAbs().maxCoeff());
  for (const double slack : kBoundarySlacks)
    if (region = clip(a, b, slack * size); !region.empty()) return region;
  region.push_back(*std::max_element(a.begin(), a.end(), [&](const auto& p, const auto& q) {
    return room_in(b, p.p) < room_in(b, q.p);
  }));
  return region;
}

// The foremost vertices of a piece, projected along n. `side` is +1 for A, whose lowest vertices
// face B. They are numbered in the order of the piece.
Polygon facing(const PlacedPolytope& piece, const PlaneAxes& axes, const Vector3d& n, double side,
               double tolerance, double& height) {
  const Vector3d d = piece.in_body(side * n);
  double lowest;
  const int foremost = piece.polytope->lowest(d, lowest);
  const auto& vertices = piece.polytope->vertices;
  Polygon points;
  for (int i = 0; i < piece.size(); ++i)
    if (i == foremost || d.dot(vertices[i]) <= lowest + tolerance)
      points.push_back({axes.flatten(piece.vertex(i)), -1});
  height = side * lowest + n.dot(piece.translation);
  return points;
}

// The region in which the two pieces face each other.
struct FacingParts {
  Polygon of_a, of_b;  // foremost vertices; those of B are empty where A faces it with a corner
  Polygon region;
  double height;  // of A's foremost vertex along n [m]
};

FacingParts parts_of(const PlacedPolytope& a, const PlacedPolytope& b, const PlaneAxes& axes,
                     const Vector3d& n, double tolerance) {
  FacingParts parts;
  parts.of_a = facing(a, axes, n, 1.0, tolerance, parts.height);
  const Polygon hull_a = hull_of(parts.of_a);
  if (hull_a.size() == 1) {
    parts.region = hull_a;
    return parts;
  }
  double height_b;
  parts.of_b = facing(b, axes, n, -1.0, tolerance, height_b);
  const Polygon hull_b = hull_of(parts.of_b);
  parts.region = hull_a.size() <= hull_b.size() ? shared_region(hull_a, hull_b)
                                                : shared_region(hull_b, hull_a);
  return parts;
}

bool is_inside(const Polygon& region, const Vector2d& p) {
  for (int k = 0; k < region.size(); ++k)
    if (!(cross2(region[k + 1 < region.size() ? k + 1 : 0].p - region[k].p, p - region[k].p) > 0))
      return false;
  return true;
}

// The set of feasible slopes s of a plane: a convex polygon, with a circle around it.
class Slopes {
 public:
  explicit Slopes(double steepest) {
    for (const Vector2d& corner :
         {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1)})
      corners_.push_back({steepest * corner, -1});
    find_circle();
  }
  /// Keeps the slopes with  d . s <= room. @return whether any is left
  bool keep(const Vector2d& d, double room) {
    const double middle = d.dot(middle_) - room;
    // the whole circle
    if (middle <= 0 && middle * middle >= square_ * d.squaredNorm()) return true;
    Polygon kept;
    for (int k = 0; k < corners_.size(); ++k) {
      const FlatPoint &q = corners_[k], &next = corners_[(k + 1) % corners_.size()];
      const double over = d.dot(q.p) - room, over_next = d.dot(next.p) - room;
      if (over <= 0) kept.push_back(q);
      if ((over < 0 && over_next > 0) || (over > 0 && over_next < 0))
        kept.push_back({q.p + (over / (over - over_next)) * (next.p - q.p), -1});
    }
    corners_ = std::move(kept);
    if (corners_.empty()) return false;
    find_circle();
    return true;
  }

 private:
  void find_circle() {
    middle_.setZero();
    for (const FlatPoint& q : corners_) middle_ += q.p / static_cast<double>(corners_.size());
    square_ = 0.0;
    for (const FlatPoint& q : corners_) square_ = std::max(square_, (q.p - middle_).squaredNorm());
  }

  Polygon corners_;
  Vector2d middle_;
  double square_ = 0.0;  // of the radius
};

// Whether all other points lie above some plane through point i: a slope s exists with
//   s . (p_j - p_i) <= height_j - height_i - tolerance  for all j.
// The nearest points come first: they leave few slopes, which most other points allow without a
// cut.
// Points are sorted by height: of two with the same projection the first is the lower.
bool lies_below_others(const Polygon& points, const PointHeights& heights, int i, double same,
                       double tolerance) {
  constexpr double kSteepest = 1e3;  // steeper planes are walls
  constexpr int kNearest = 8;
  InlineVector<std::pair<double, int>, 16> others;
  for (int j = 0; j < points.size(); ++j) {
    const double square = (points[j].p - points[i].p).squaredNorm();
    if (square > same * same)
      others.push_back({square, j});
    else if (j < i)
      return false;
  }
  const auto near = others.begin() + std::min(kNearest, others.size());
  std::nth_element(others.begin(), near, others.end());
  Slopes slopes(kSteepest);
  return std::all_of(others.begin(), others.end(), [&](const auto& other) {
    const int j = other.second;
    return slopes.keep(points[j].p - points[i].p, heights[j] - heights[i] - tolerance);
  });
}

Vector2d middle_of(const Polygon& hull) {
  Vector2d middle = Vector2d::Zero();
  double area = 0.0;
  const Vector2d& start = hull[0].p;
  for (int i = 1; i + 1 < hull.size(); ++i) {
    const Vector2d p = hull[i].p - start, q = hull[i + 1].p - start;
    area += cross2(p, q);
    middle += cross2(p, q) * (p + q) / 3.0;
  }
  if (hull.size() >= 3 && area > 0) return start + middle / area;
  middle.setZero();
  for (const FlatPoint& q : hull) middle += q.p / static_cast<double>(hull.size());
  return middle;
}

}  // namespace

Corners facing_region(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n,
                      double tolerance) {
  const PlaneAxes axes(n);
  const FacingParts parts = parts_of(a, b, axes, n, tolerance);
  Corners corners;
  const auto add = [&](const Vector2d& p) {
    corners.push_back(p.x() * axes.u + p.y() * axes.v + parts.height * n);
  };
  for (const FlatPoint& q : parts.region) add(q.p);
  if (parts.region.size() < 3) return corners;
  for (const Polygon* vertices : {&parts.of_a, &parts.of_b})
    for (const FlatPoint& q : *vertices)
      if (is_inside(parts.region, q.p)) add(q.p);
  return corners;
}

Vector3d middle_of_facing_region(const PlacedPolytope& a, const PlacedPolytope& b,
                                 const Vector3d& n, double tolerance) {
  const PlaneAxes axes(n);
  const FacingParts parts = parts_of(a, b, axes, n, tolerance);
  const Vector2d middle = middle_of(hull_of(parts.region));
  return middle.x() * axes.u + middle.y() * axes.v + parts.height * n;
}

FlatHull flat_hull(const std::vector<Vector3d>& points, const Vector3d& n) {
  const PlaneAxes axes(n);
  Polygon flat;
  for (const Vector3d& p : points) flat.push_back({axes.flatten(p - points[0]), -1});
  const Polygon hull = hull_of(flat);
  const auto lift = [&](const Vector2d& p) -> Vector3d {
    return points[0] + p.x() * axes.u + p.y() * axes.v;
  };
  FlatHull result;
  for (const FlatPoint& q : hull) result.corners.push_back(lift(q.p));
  result.middle = lift(middle_of(hull));
  return result;
}

InlineVector<int, 16> hull_corners(const Corners& points, const Vector3d& n) {
  const PlaneAxes axes(n);
  Polygon flat;
  for (int i = 0; i < points.size(); ++i) flat.push_back({axes.flatten(points[i] - points[0]), i});
  InlineVector<int, 16> corners;
  for (const FlatPoint& q : hull_of(flat)) corners.push_back(q.index);
  return corners;
}

InlineVector<int, 16> lower_corners(const Corners& points, const InlineVector<double, 16>& heights,
                                    const Vector3d& n, double tolerance) {
  const PlaneAxes axes(n);
  Polygon flat;
  for (int i = 0; i < points.size(); ++i) flat.push_back({axes.flatten(points[i] - points[0]), i});
  std::sort(flat.begin(), flat.end(), [&](const FlatPoint& p, const FlatPoint& q) {
    return heights[p.index] != heights[q.index] ? heights[p.index] < heights[q.index]
                                                : p.index < q.index;
  });
  // by place in the order of heights: of points that coincide the lowest counts
  Polygon renamed = flat;
  for (int i = 0; i < renamed.size(); ++i) renamed[i].index = i;
  InlineVector<int, 16> corners;
  InlineVector<char, 16> outer;
  PointHeights ordered;
  for (const FlatPoint& q : flat) {
    outer.push_back(0);
    ordered.push_back(heights[q.index]);
  }
  double size = 0.0;
  for (const FlatPoint& q : hull_of(renamed)) {
    corners.push_back(flat[q.index].index);
    outer[q.index] = 1;
    size = std::max(size, (q.p - flat[0].p).norm());
  }
  for (int i = 0; i < flat.size(); ++i)
    if (!outer[i] && lies_below_others(flat, ordered, i, 1e-12 * size, tolerance))
      corners.push_back(flat[i].index);
  return corners;
}

}  // namespace tumble::collision
