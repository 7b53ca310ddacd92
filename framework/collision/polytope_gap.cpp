#include "framework/collision/polytope_gap.h"

#include <cmath>

#include "framework/collision/axes.h"
#include "framework/collision/expanding.h"
#include "framework/collision/gjk.h"
#include "framework/collision/patch.h"
#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// Relative to the size: at smaller distances the direction between the nearest points has fewer
// than ten digits, and axes are used.
constexpr double kNearZone = 1e-6;
// Relative to the size: vertices within this distance of the foremost one face the other body too.
// A face tilted by 1e-9 counts as flat.
constexpr double kFacing = 1e-9;
// Relative to the size: at smaller distances an axis is always more accurate than the nearest
// points.
constexpr double kTrusted = 1e-13;
// Roundings of the size by which nearest points may be off: up to 600 are seen of equal boxes in
// stacks that lie obliquely in the world, which tilts their direction by 1e-3 rad at a gap of
// 3e-11 m. At larger angles (rad) than kWidestSearch two points tell no direction.
constexpr double kOffRoundings = 4096, kWidestSearch = 0.1;
// Up to this many pairs of edges, testing all is faster than selecting: boxes and triangles.
constexpr std::size_t kFewPairs = 32;
// Angles (rad) around the direction from the expanding polytope algorithm within which the axis is
// searched: usually, and where facets are slivers.
constexpr double kSearchAngles[] = {1e-7, 1e-3};
// Relative to the size: faces closer than this touch. A few roundings, and less than what
// searches among pieces look beyond their limit.
constexpr double kTouchingFaces = 32 * kEpsilon;
// rad: faces at a smaller angle lie in one plane.
constexpr double kSinglePlane = 1e-6;

PolytopeGap from_simplex(const PlacedPolytope& a, const PlacedPolytope& b, const GjkResult& found) {
  PolytopeGap gap;
  const Simplex& s = found.simplex;
  gap.distance = found.distance;
  gap.normal_b_to_a = found.normal;
  gap.point_a = gap.point_b = Vector3d::Zero();
  for (int i = 0; i < s.size; ++i) {
    gap.point_a += s.weights[i] * a.vertex(s.points[i].vertex_a);
    gap.point_b += s.weights[i] * b.vertex(s.points[i].vertex_b);
  }
  return gap;
}

PolytopeGap from_axis(const PlacedPolytope& a, const PlacedPolytope& b, const Axis& axis,
                      double size, Points points) {
  PolytopeGap gap{axis.separation, Vector3d::Zero(), Vector3d::Zero(), axis.normal_b_to_a};
  if (points == Points::kUnwanted) return gap;
  gap.point_a = middle_of_facing_region(a, b, axis.normal_b_to_a, kFacing * size);
  gap.point_b = gap.point_a - axis.separation * axis.normal_b_to_a;
  return gap;
}

bool has_few_axes(const PlacedPolytope& a, const PlacedPolytope& b) {
  return a.polytope->edge_directions.size() * b.polytope->edge_directions.size() <= kFewPairs;
}

// For touching or overlapping solids. The nearest face of A - B is an upper bound of the
// separation.
Axis axis_of_overlap(const PlacedPolytope& a, const PlacedPolytope& b, const Simplex& simplex,
                     double size) {
  if (has_few_axes(a, b)) return best_axis(a, b, size);
  if (const auto bound = expand(a, b, simplex, size)) {
    for (const double look : kSearchAngles) {
      const Axis axis = best_axis_near(a, b, bound->normal_b_to_a, look, size);
      if (axis.separation >= bound->separation - 32 * kEpsilon * size) return axis;
    }
  }
  return best_axis(a, b, size);
}

}  // namespace

PolytopeGap polytope_gap(const PlacedPolytope& a, const PlacedPolytope& b, double size,
                         double limit, Points points) {
  const GjkResult found = gjk(a, b, size, limit);
  if (found.verdict == Apartness::kBeyond)
    return {found.lower_bound, Vector3d::Zero(), Vector3d::Zero(), found.normal, true};
  if (found.verdict == Apartness::kApart) {
    const PolytopeGap gap = from_simplex(a, b, found);
    if (gap.distance > kNearZone * size) return gap;
    // Rounding error of the direction between the nearest points.
    const double angle = std::min(1e-2, std::max(1e-7, 16 * kEpsilon * size / gap.distance));
    const Axis axis = best_axis_near(a, b, gap.normal_b_to_a, angle, size);
    if (axis.separation * (1 + 1e-9) + 16 * kEpsilon * size >= gap.distance)
      return from_axis(a, b, axis, size, points);
    // Where the simplex is a sliver, the nearest points are off by some hundred roundings, sideways
    // and in their distance. An axis within that angle which holds the two apart by as much is the
    // direction.
    const double wide = std::min(kWidestSearch, kOffRoundings * kEpsilon * size / gap.distance);
    if (wide > angle) {
      const Axis near = best_axis_near(a, b, gap.normal_b_to_a, wide, size);
      if (near.separation + 0.25 * kOffRoundings * kEpsilon * size >= gap.distance)
        return from_axis(a, b, near, size, points);
    }
    // Corner against corner, or corner against edge: their distance lies along no axis of faces and
    // edges, so the GJK distance is used.
    if (gap.distance > kTrusted * size) return gap;
  }
  const Axis axis = axis_of_overlap(a, b, found.simplex, size);
  if (!std::isfinite(axis.separation)) {  // two points
    if (found.verdict == Apartness::kApart) return from_simplex(a, b, found);
    return {0.0, a.vertex(0), b.vertex(0), Vector3d::UnitZ()};
  }
  return from_axis(a, b, axis, size, points);
}

PolytopeGap surface_gap(const PlacedPolytope& a, const PlacedPolytope& b, double size, double limit,
                        Points points) {
  PolytopeGap found = polytope_gap(a, b, size, limit, points);
  const double touching = kTouchingFaces * size;
  if (found.beyond || std::abs(found.distance) > touching) return found;
  const auto outward = [](const PlacedPolytope& piece) {
    return Vector3d(piece.query_from_body * piece.polytope->face_normals.front());
  };
  BarredAxes from_within;
  if (a.polytope->is_face) from_within.first = outward(a);
  if (b.polytope->is_face) from_within.second = -outward(b);
  if (!from_within.holds(found.normal_b_to_a)) return found;
  const Axis axis = best_axis(a, b, size, &from_within);
  if (!std::isfinite(axis.separation)) return found;  // a point has no axis of its own
  const auto apart_along = [&](const std::optional<Vector3d>& n) {
    return n && separation_along(a, b, *n) >= -touching;
  };
  // of faces in one plane the two directions are one line
  if (axis.separation < -touching && apart_along(from_within.first) &&
      apart_along(from_within.second) &&
      from_within.first->cross(*from_within.second).norm() > kSinglePlane) {
    found.grazes = true;
    return found;
  }
  return from_axis(a, b, axis, size, points);
}

}  // namespace tumble::collision
