#include "framework/collision/manifold_points.h"

#include <algorithm>
#include <cmath>

#include "framework/collision/edge_on_edge.h"
#include "framework/collision/patch.h"
#include "framework/collision/piece_pairs.h"
#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// rad: a contact normal this close to the normal of one of the two faces is a face normal.
constexpr double kOfAFace = 1e-6;
// Normals closer than this (rad) belong to one region.
constexpr double kSameNormal = 1e-6;
// A face whose normal has a smaller cosine to the contact normal is too steep to bound a column
// along it.
constexpr double kSteep = 0.05;
// A face whose normal has a larger cosine to the direction away from the other solid is on the far
// side.
constexpr double kBack = 0.5;
// Relative to a solid's size: vertices whose heights differ by less have equal height.
constexpr double kSameHeight = 1e-9;
// Relative to the query's size: at larger distances the nearest points of two edges define the
// contact normal.
constexpr double kInTouch = 1e-6;

// Height along n of the surface of a convex piece at a point: for `side` +1 the lowest of A, for -1
// the highest of B. Where no face points towards the other solid (an edge, a corner), the vertices
// bound it.
class Surface {
 public:
  Surface(const PlacedPolytope& piece, const Vector3d& n, double side)
      : piece_(piece),
        side_(side),
        direction_body_(piece.in_body(side * n)),
        foremost_(piece.polytope->lowest_height(direction_body_)),
        base_(n.dot(piece.translation)) {}
  double height_at(const Vector3d& over) const {
    const Vector3d over_body = piece_.in_body(over - piece_.translation);
    const double entry = piece_.polytope->entry_along(direction_body_, over_body, kSteep);
    return side_ * std::max(foremost_, direction_body_.dot(over_body) + entry) + base_;
  }

 private:
  const PlacedPolytope& piece_;
  double side_;
  Vector3d direction_body_;
  double foremost_, base_;  // [m]
};

std::vector<ManifoldPoint> nearest_point(const CollisionShape& a, const Pose& pose_a,
                                         const CollisionShape& b, const Pose& pose_b, double reach,
                                         PairCache* cache) {
  const Gap gap = compute_gap(a, pose_a, b, pose_b, cache);
  if (gap.distance > reach) return {};
  return {{gap.point_a_world, gap.point_b_world, gap.normal_b_to_a_world, gap.distance}};
}

std::vector<ManifoldPoint> above_half_space(const CollisionShape& a, const Pose& pose_a,
                                            const Pose& plane, double reach) {
  const Matrix3d R = pose_a.world_from_body.toRotationMatrix();
  const Vector3d n = plane.world_from_body.toRotationMatrix().col(2);
  const double height = n.dot(pose_a.com_world - plane.com_world) - a.radius();
  std::vector<ManifoldPoint> points;
  for (const Vector3d& v : a.vertices()) {
    const Vector3d arm = R * v;
    const double gap = height + n.dot(arm);
    if (gap > reach) continue;
    const Vector3d point = pose_a.com_world + arm - a.radius() * n;
    points.push_back({point, point - gap * n, n, gap});
  }
  constexpr std::size_t kFew = 3;
  if (points.size() <= kFew) return points;
  Corners places;
  InlineVector<double, 16> heights;
  for (const ManifoldPoint& point : points) {
    places.push_back(point.point_a_world);
    heights.push_back(point.gap);
  }
  auto lower = lower_corners(places, heights, n, kSameHeight * a.bounding_radius());
  std::sort(lower.begin(), lower.end());  // in the order of the vertices
  std::vector<ManifoldPoint> corners;
  corners.reserve(static_cast<std::size_t>(lower.size()));
  for (const int i : lower) corners.push_back(points[static_cast<std::size_t>(i)]);
  return corners;
}

ManifoldPoint flipped(const ManifoldPoint& p) {
  return {p.point_b_world, p.point_a_world, -p.normal_b_to_a_world, p.gap};
}

struct Region {
  Vector3d normal;
  InlineVector<ManifoldPoint, 8> points;
};

// The first normal of a flat piece is that of its face; its back and its sides are not part of a
// solid's surface.
bool of_a_face(const PlacedPolytope& a, bool a_is_flat, const PlacedPolytope& b, bool b_is_flat,
               const Vector3d& n) {
  const auto faces = [](const PlacedPolytope& piece, bool is_flat, const Vector3d& direction) {
    const auto& normals = piece.polytope->face_normals;
    const Vector3d d = piece.in_body(direction);
    const auto end = is_flat && !normals.empty() ? normals.begin() + 1 : normals.end();
    return std::any_of(normals.begin(), end,
                       [&](const Vector3d& m) { return (m - d).norm() < kOfAFace; });
  };
  return faces(b, b_is_flat, n) || faces(a, a_is_flat, -n);
}

// Whether a flat piece is turned away from the other solid, like the far side of a thin plate.
// `away` points from the other to the piece.
bool is_far_side(const PlacedPolytope& piece, bool is_flat, const Vector3d& away) {
  const auto& normals = piece.polytope->face_normals;
  return is_flat && !normals.empty() && normals.front().dot(piece.in_body(away)) > kBack;
}

// Whether the vertices with which a piece touches protrude from the surface around them: then the
// contact is that of an edge or a corner of the solid. Otherwise it is that of a seam, and the
// neighbouring face has the contact. `down` points from the piece to the other.
bool protrudes(const CollisionShape& shape, int piece, const PlacedPolytope& placed,
               const Vector3d& down) {
  if (!shape.is_closed_surface()) return true;
  const Vector3d d = placed.in_body(down);
  const Face& face = shape.vertices_of_piece(piece);
  const double slack = kSameHeight * shape.bounding_radius();
  double foremost = -kInfinity;
  for (const int v : face) foremost = std::max(foremost, d.dot(shape.vertices()[v]));
  // For an edge only the vertices of its two faces count: other faces at its ends, in a corner that
  // is not convex, may protrude farther.
  InlineVector<int, 4> touching;
  for (const int v : face)
    if (d.dot(shape.vertices()[v]) >= foremost - slack) touching.push_back(v);
  const bool is_edge = touching.size() == 2;
  for (const int v : touching)
    for (const int w : shape.neighbours(v)) {
      if (d.dot(shape.vertices()[w]) <= foremost + slack) continue;
      if (!is_edge) return false;
      const auto& of_other = shape.neighbours(v == touching[0] ? touching[1] : touching[0]);
      if (std::find(of_other.begin(), of_other.end(), w) != of_other.end()) return false;
    }
  return true;
}

struct NearPair {
  int i, j;
  PolytopeGap gap;
};

// Contact points at the corners of the common region of two pieces.
void add_points(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n, double reach,
                const Vector3d& com_b_world, Region& region) {
  const Corners corners = facing_region(a, b, n, reach);
  if (corners.empty()) return;
  const Surface surface_a(a, n, 1.0), surface_b(b, n, -1.0);
  for (const Vector3d& corner : corners) {
    const double low = surface_a.height_at(corner), high = surface_b.height_at(corner);
    if (low - high > reach) continue;
    const Vector3d flat = corner - n.dot(corner) * n;
    region.points.push_back(
        {com_b_world + flat + low * n, com_b_world + flat + high * n, n, low - high});
  }
}

// Only points that a plate could rest on can carry; the others lie between them.
void append_corners(const Region& region, double size, std::vector<ManifoldPoint>& points) {
  if (region.points.size() == 1) return points.push_back(region.points[0]);
  Corners all;
  InlineVector<double, 16> gaps;
  for (const ManifoldPoint& p : region.points) {
    all.push_back(p.point_a_world);
    gaps.push_back(p.gap);
  }
  const auto lower = lower_corners(all, gaps, region.normal, kSameHeight * size);
  points.reserve(points.size() + static_cast<std::size_t>(lower.size()));
  for (const int corner : lower) points.push_back(region.points[corner]);
}

// The ends of the common segment of two edges, each with its own gap, and the other points within
// reach. At the ends the gap is that of the edges, because the adjacent faces slope away.
std::vector<ManifoldPoint> along_edges(const PlacedPolytope& a, const PlacedPolytope& b,
                                       const EdgeOnEdge& shared, double reach, double size,
                                       const Vector3d& com_b_world) {
  const Vector3d& n = shared.normal_b_to_a;
  const double near = kInTouch * size;
  Region region{n, {}};
  for (const std::size_t end : {0, 1}) {
    const double gap = n.dot(shared.on_a[end] - shared.on_b[end]);
    if (gap <= reach)
      region.points.push_back(
          {com_b_world + shared.on_a[end], com_b_world + shared.on_a[end] - gap * n, n, gap});
  }
  const Vector3d along = (shared.on_a[1] - shared.on_a[0]).normalized(),
                 start = com_b_world + shared.on_a[0];
  Region others{n, {}};
  if (reach > near) add_points(a, b, n, reach, com_b_world, others);
  for (const ManifoldPoint& p : others.points)
    if ((p.point_a_world - start).cross(along).norm() > 2 * near) region.points.push_back(p);
  std::vector<ManifoldPoint> points;
  if (region.points.size() > 0) append_corners(region, size, points);
  return points;
}

std::vector<ManifoldPoint> between_convex(const Query& query, const Vector3d& com_b_world,
                                          double reach, PairCache* cache) {
  const PlacedPolytope placed_a = query.piece_of_a(0), placed_b = query.piece_of_b(0);
  const PolytopeGap found = convex_gap(query, reach, cache, Points::kWanted);
  if (found.beyond || found.distance > reach) return {};
  if (found.distance <= kInTouch * query.size)
    if (const auto edges = edge_on_edge(placed_a, placed_b, found.normal_b_to_a, query.size))
      return along_edges(placed_a, placed_b, *edges, reach, query.size, com_b_world);
  Region region{found.normal_b_to_a, {}};
  add_points(placed_a, placed_b, region.normal, reach, com_b_world, region);
  // the crossing of two edges
  region.points.push_back(
      {com_b_world + found.point_a, com_b_world + found.point_b, region.normal, found.distance});
  std::vector<ManifoldPoint> points;
  append_corners(region, query.size, points);
  return points;
}

// Pairs of pieces with a contact normal of the solids' surfaces (not of a seam), or with that of
// the nearest pair. `radii` are those of balls.
std::vector<NearPair> contact_pairs(const Query& query, double reach, double radii, Points points,
                                    PairCache* cache) {
  const bool flat_a = query.a.is_closed_surface(), flat_b = query.b.is_closed_surface();
  double nearest = kInfinity;
  Vector3d main_normal = Vector3d::UnitZ();
  std::vector<NearPair> pairs;
  for (const auto& [i, j] : pieces_within(query, reach + radii, cache)) {
    const PolytopeGap found =
        polytope_gap(query.piece_of_a(i), query.piece_of_b(j), query.size, reach + radii, points);
    if (found.beyond || found.distance > reach + radii) continue;
    if (is_far_side(query.piece_of_a(i), flat_a, found.normal_b_to_a) ||
        is_far_side(query.piece_of_b(j), flat_b, -found.normal_b_to_a))
      continue;
    pairs.push_back({i, j, found});
    if (found.distance < nearest) {
      nearest = found.distance;
      main_normal = found.normal_b_to_a;
    }
  }
  std::erase_if(pairs, [&](const NearPair& pair) {
    const PlacedPolytope placed_a = query.piece_of_a(pair.i), placed_b = query.piece_of_b(pair.j);
    const Vector3d& n = pair.gap.normal_b_to_a;
    const bool own =
        (n - main_normal).norm() <= kSameNormal ||
        of_a_face(placed_a, flat_a, placed_b, flat_b, n) ||
        (protrudes(query.a, pair.i, placed_a, -n) && protrudes(query.b, pair.j, placed_b, n));
    return !own;
  });
  return pairs;
}

// A ball in a corner of a surface touches each wall.
std::vector<ManifoldPoint> of_a_ball(const Query& query, const Vector3d& com_b_world, double reach,
                                     PairCache* cache) {
  const double radius_a = query.a.radius(), radius_b = query.b.radius();
  std::vector<ManifoldPoint> points;
  for (const NearPair& pair :
       contact_pairs(query, reach, radius_a + radius_b, Points::kWanted, cache)) {
    const Vector3d& n = pair.gap.normal_b_to_a;
    const ManifoldPoint point{com_b_world + pair.gap.point_a - radius_a * n,
                              com_b_world + pair.gap.point_b + radius_b * n, n,
                              pair.gap.distance - radius_a - radius_b};
    const auto same = std::find_if(points.begin(), points.end(), [&](const ManifoldPoint& p) {
      return (p.normal_b_to_a_world - n).norm() <= kSameNormal;
    });
    if (same == points.end())
      points.push_back(point);
    else if (point.gap < same->gap)
      *same = point;
  }
  return points;
}

std::vector<ManifoldPoint> between_surfaces(const Query& query, const Vector3d& com_b_world,
                                            double reach, PairCache* cache) {
  std::vector<Region> regions;
  for (const NearPair& pair : contact_pairs(query, reach, 0.0, Points::kUnwanted, cache)) {
    const PlacedPolytope placed_a = query.piece_of_a(pair.i), placed_b = query.piece_of_b(pair.j);
    const Vector3d& n = pair.gap.normal_b_to_a;
    auto region = std::find_if(regions.begin(), regions.end(), [&](const Region& r) {
      return (r.normal - n).norm() <= kSameNormal;
    });
    if (region == regions.end()) region = regions.insert(regions.end(), {n, {}});
    add_points(placed_a, placed_b, n, reach, com_b_world, *region);
  }
  std::vector<ManifoldPoint> points;
  for (const Region& region : regions) append_corners(region, query.size, points);
  return points;
}

}  // namespace

std::vector<ManifoldPoint> manifold_points(const CollisionShape& a, const Pose& pose_a,
                                           const CollisionShape& b, const Pose& pose_b,
                                           double reach, PairCache* cache) {
  if (a.ellipsoid() || b.ellipsoid()) return nearest_point(a, pose_a, b, pose_b, reach, cache);
  if (b.is_half_space())
    return a.is_half_space() ? std::vector<ManifoldPoint>{}
                             : above_half_space(a, pose_a, pose_b, reach);
  if (a.is_half_space()) {
    std::vector<ManifoldPoint> points = above_half_space(b, pose_b, pose_a, reach);
    for (ManifoldPoint& p : points) p = flipped(p);
    return points;
  }
  const Query query(a, pose_a, b, pose_b);
  const bool convex = !a.is_closed_surface() && !b.is_closed_surface(),
             of_ball = a.is_ball() || b.is_ball();
  if (of_ball && !convex) return of_a_ball(query, pose_b.com_world, reach, cache);
  if (of_ball) return nearest_point(a, pose_a, b, pose_b, reach, cache);
  return convex ? between_convex(query, pose_b.com_world, reach, cache)
                : between_surfaces(query, pose_b.com_world, reach, cache);
}

}  // namespace tumble::collision
