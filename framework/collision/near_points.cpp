#include "framework/collision/near_points.h"

#include <algorithm>
#include <cmath>

#include "framework/collision/patch.h"
#include "framework/collision/piece_pairs.h"

namespace tumble::collision {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Pieces of a surface that is not convex push along a normal of their own if it is that of one of their faces, to this (rad).
constexpr double kOfAFace = 1e-6;
// Normals closer than this (rad) are one region's.
constexpr double kSameNormal = 1e-6;
// A face that leans more from the normal than this cosine does not bound a column along it.
constexpr double kSteep = 0.05;

// Height along n of the foremost surface of a convex piece over a point, `side` +1: the lowest of A, -1: the highest of B. The
// vertices bound it where no face looks that way (an edge, a corner).
double height_of(const PlacedPolytope& piece, const Vector3d& n, double side, const Vector3d& over) {
  double foremost = kInfinity;
  for (const Vector3d& v : piece.vertices) foremost = std::min(foremost, side * n.dot(v));
  double height = foremost;
  const double base = n.dot(over);
  for (const Vector3d& body_normal : piece.polytope->face_normals) {
    const Vector3d m = piece.query_from_body * body_normal;
    const double lean = side * n.dot(m);
    if (lean > -kSteep) continue;
    double offset = -kInfinity;
    for (const Vector3d& v : piece.vertices) offset = std::max(offset, m.dot(v));
    // m . (over + s n) = offset at the face
    const double s = (offset - m.dot(over)) / n.dot(m);
    height = std::max(height, side * (base + s));
  }
  return side * height;
}

std::vector<NearPoint> above_half_space(const CollisionShape& a, const Pose& pose_a, const Pose& plane, double reach) {
  const Matrix3d R = pose_a.world_from_body.toRotationMatrix();
  const Vector3d n = plane.world_from_body.toRotationMatrix().col(2);
  const double height = n.dot(pose_a.com_world - plane.com_world) - a.radius();
  std::vector<NearPoint> points;
  std::vector<Vector3d> foremost;
  double lowest = kInfinity;
  for (const Vector3d& v : a.vertices()) lowest = std::min(lowest, n.dot(R * v));
  if (lowest + height > reach) return {};
  for (const Vector3d& v : a.vertices()) {
    const Vector3d arm = R * v;
    const double gap = height + n.dot(arm);
    if (gap > reach) continue;
    const Vector3d point = pose_a.com_world + arm - a.radius() * n;
    points.push_back({point, point - gap * n, n, gap});
    foremost.push_back(point);
  }
  constexpr std::size_t kFew = 4;
  if (points.size() <= kFew) return points;
  // Only corners of their hull carry: the others lie between.
  const FlatHull hull = flat_hull(foremost, n);
  std::vector<NearPoint> corners;
  for (const NearPoint& point : points) {
    const bool is_corner = std::any_of(hull.corners.begin(), hull.corners.end(), [&](const Vector3d& c) {
      const Vector3d between = c - point.point_a_world;
      return (between - n.dot(between) * n).norm() <= 1e-12 * a.bounding_radius();
    });
    // Vertices above one another over a corner: the lowest.
    if (!is_corner) continue;
    const auto same = std::find_if(corners.begin(), corners.end(), [&](const NearPoint& other) {
      const Vector3d between = other.point_a_world - point.point_a_world;
      return (between - n.dot(between) * n).norm() <= 1e-12 * a.bounding_radius();
    });
    if (same == corners.end()) corners.push_back(point);
    else if (point.gap < same->gap) *same = point;
  }
  return corners;
}

NearPoint flipped(const NearPoint& p) { return {p.point_b_world, p.point_a_world, -p.normal_b_to_a_world, p.gap}; }

struct Region {
  Vector3d normal;
  std::vector<NearPoint> points;
};

bool of_a_face(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n) {
  const auto faces = [&](const PlacedPolytope& piece, const Vector3d& direction) {
    return !piece.polytope->face_normals.empty() && (piece.query_from_body * piece.polytope->face_normals.front() - direction).norm() < kOfAFace;
  };
  return faces(b, n) || faces(a, -n);
}

}  // namespace

std::vector<NearPoint> near_points(const CollisionShape& a, const Pose& pose_a, const CollisionShape& b, const Pose& pose_b, double reach) {
  if (b.is_half_space()) return a.is_half_space() ? std::vector<NearPoint>{} : above_half_space(a, pose_a, pose_b, reach);
  if (a.is_half_space()) {
    std::vector<NearPoint> points = above_half_space(b, pose_b, pose_a, reach);
    for (NearPoint& p : points) p = flipped(p);
    return points;
  }
  if (a.is_ball() || b.is_ball()) {
    const Gap gap = compute_gap(a, pose_a, b, pose_b);
    if (gap.distance > reach) return {};
    return {{gap.point_a_world, gap.point_b_world, gap.normal_b_to_a_world, gap.distance}};
  }
  const Query query(a, pose_a, b, pose_b);
  const bool convex = !a.is_closed_surface() && !b.is_closed_surface();
  std::vector<Region> regions;
  double nearest = kInfinity;
  Vector3d main_normal = Vector3d::UnitZ();
  PlacedPolytope placed_a, placed_b;
  struct Pair { int i, j; PolytopeGap gap; };
  std::vector<Pair> pairs;
  visit_piece_pairs(
      query, [&](double bound) { return bound > reach; },
      [&](int i, int j) {
        placed_a.place(a.pieces()[i], query.rotation_a, query.offset);
        placed_b.place(b.pieces()[j], query.rotation_b, Vector3d::Zero());
        const PolytopeGap found = polytope_gap(placed_a, placed_b, query.size);
        if (found.distance > reach) return;
        pairs.push_back({i, j, found});
        if (found.distance < nearest) {
          nearest = found.distance;
          main_normal = found.normal_b_to_a;
        }
      });
  for (const Pair& pair : pairs) {
    placed_a.place(a.pieces()[pair.i], query.rotation_a, query.offset);
    placed_b.place(b.pieces()[pair.j], query.rotation_b, Vector3d::Zero());
    const Vector3d& n = pair.gap.normal_b_to_a;
    if (!convex && (n - main_normal).norm() > kSameNormal && !of_a_face(placed_a, placed_b, n)) continue;
    auto region = std::find_if(regions.begin(), regions.end(), [&](const Region& r) { return (r.normal - n).norm() <= kSameNormal; });
    if (region == regions.end()) region = regions.insert(regions.end(), {n, {}});
    for (const Vector3d& corner : facing_region(placed_a, placed_b, n, reach)) {
      const double low = height_of(placed_a, n, 1.0, corner), high = height_of(placed_b, n, -1.0, corner);
      const Vector3d flat = corner - n.dot(corner) * n;
      const NearPoint point{pose_b.com_world + flat + low * n, pose_b.com_world + flat + high * n, n, low - high};
      if (point.gap <= reach) region->points.push_back(point);
    }
  }
  std::vector<NearPoint> points;
  for (const Region& region : regions) {
    if (region.points.size() <= 2) {
      points.insert(points.end(), region.points.begin(), region.points.end());
      continue;
    }
    std::vector<Vector3d> all;
    for (const NearPoint& p : region.points) all.push_back(p.point_a_world);
    for (const Vector3d& corner : flat_hull(all, region.normal).corners) {
      // flat_hull lifts corners to its first point's height: the point itself has its own.
      const NearPoint* best = nullptr;
      double best_distance = kInfinity;
      for (const NearPoint& p : region.points) {
        const Vector3d between = corner - p.point_a_world;
        const double distance = (between - region.normal.dot(between) * region.normal).norm();
        if (distance < best_distance) {
          best_distance = distance;
          best = &p;
        }
      }
      points.push_back(*best);
    }
  }
  return points;
}

}  // namespace tumble::collision
