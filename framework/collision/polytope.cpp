#include "framework/collision/polytope.h"

#include <cmath>
#include <limits>

#include "framework/collision/patch.h"
#include "framework/collision/simplex.h"

namespace tumble::collision {
namespace {

constexpr double kRoundOff = 2.220446049250313e-16;
// Below this part of the size, the direction between the nearest points carries fewer than ten digits: axes take over.
constexpr double kNearZone = 1e-6;
// Vertices within this part of the size of the foremost face the other body together: a face that leans by 1e-9 lies flat.
constexpr double kFacing = 1e-9;
// Edges more parallel than this (rad) span no axis of their own: faces and other edges cover them.
constexpr double kParallel = 1e-9;

int lowest(const std::vector<Vector3d>& points, const Vector3d& direction) {
  int best = 0;
  double value = points[0].dot(direction);
  for (int i = 1; i < static_cast<int>(points.size()); ++i) {
    const double v = points[i].dot(direction);
    if (v < value) {
      value = v;
      best = i;
    }
  }
  return best;
}

struct GjkResult {
  bool apart;
  Simplex simplex;
  Vector3d nearest;   // of A - B to the origin
};

GjkResult gjk(const PlacedPolytope& a, const PlacedPolytope& b, double size) {
  GjkResult result;
  const auto support = [&](const Vector3d& direction) {
    const int i = lowest(a.vertices, direction), j = lowest(b.vertices, -direction);
    return DifferencePoint{a.vertices[i] - b.vertices[j], i, j};
  };
  Simplex& simplex = result.simplex;
  simplex.points[0] = support(a.vertices[0] - b.vertices[0]);
  simplex.size = 1;
  result.nearest = reduce_to_nearest(simplex);
  const double touching = 8 * kRoundOff * size;
  constexpr int kMostRounds = 200;  // polytopes of a thousand vertices take about thirty
  for (int round = 0; round < kMostRounds; ++round) {
    const double squared = result.nearest.squaredNorm();
    if (squared <= touching * touching) break;
    const DifferencePoint next = support(result.nearest);
    // The plane through `next` bounds the distance from below: where it meets the nearest point, that is the answer.
    if (squared - result.nearest.dot(next.difference) <= kRoundOff * squared) break;
    bool known = false;
    for (int i = 0; i < simplex.size; ++i)
      known = known || (simplex.points[i].vertex_a == next.vertex_a && simplex.points[i].vertex_b == next.vertex_b);
    if (known) break;
    Simplex grown = simplex;
    grown.points[grown.size++] = next;
    const Vector3d nearest = reduce_to_nearest(grown);
    if (grown.size == 4) {
      result.apart = false;
      return result;
    }
    if (!(nearest.squaredNorm() < squared)) break;  // round-off ends the descent
    simplex = grown;
    result.nearest = nearest;
  }
  result.apart = result.nearest.norm() > touching;
  return result;
}

PolytopeGap from_simplex(const PlacedPolytope& a, const PlacedPolytope& b, const GjkResult& found) {
  PolytopeGap gap;
  const Simplex& s = found.simplex;
  gap.distance = found.nearest.norm();
  gap.normal_b_to_a = found.nearest / gap.distance;
  gap.point_a = gap.point_b = Vector3d::Zero();
  for (int i = 0; i < s.size; ++i) {
    gap.point_a += s.weights[i] * a.vertices[s.points[i].vertex_a];
    gap.point_b += s.weights[i] * b.vertices[s.points[i].vertex_b];
  }
  if (s.size == 3) {
    // A face against a corner, or an edge against an edge: the plane of the three gives the normal to full precision,
    // which the difference of two near points cannot.
    const Vector3d u = s.points[1].difference - s.points[0].difference, v = s.points[2].difference - s.points[0].difference;
    const Vector3d across = u.cross(v);
    const double area = across.norm();
    if (area > 1e-6 * u.norm() * v.norm()) {
      Vector3d n = across / area;
      if (n.dot(gap.normal_b_to_a) < 0) n = -n;
      const double distance = n.dot(s.points[0].difference);
      if (std::abs(distance - gap.distance) <= 1e-6 * gap.distance) {
        gap.distance = distance;
        gap.normal_b_to_a = n;
      }
    }
  }
  return gap;
}

struct BestAxis {
  double separation = -std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::UnitZ();
};

BestAxis best_separating_axis(const PlacedPolytope& a, const PlacedPolytope& b, double size) {
  BestAxis best;
  const auto offer = [&](const Vector3d& n, double handicap) {
    const double s = separation_along(a, b, n);
    if (s > best.separation + handicap) best = {s, n};
  };
  for (const Vector3d& n : a.polytope->face_normals) offer(-(a.query_from_body * n), 0.0);
  for (const Vector3d& n : b.polytope->face_normals) offer(b.query_from_body * n, 0.0);
  // A face is preferred to an edge pair that separates no better: parallel faces meet with the faces' normal.
  const double handicap = 16 * kRoundOff * size;
  for (const Vector3d& ea : a.polytope->edge_directions) {
    const Vector3d edge_a = a.query_from_body * ea;
    for (const Vector3d& eb : b.polytope->edge_directions) {
      const Vector3d across = edge_a.cross(b.query_from_body * eb);
      const double sine = across.norm();
      if (sine < kParallel) continue;
      offer(across / sine, handicap);
      offer(-across / sine, handicap);
    }
  }
  return best;
}

}  // namespace

void PlacedPolytope::place(const Polytope& shape, const Matrix3d& rotation, const Vector3d& translation) {
  polytope = &shape;
  query_from_body = rotation;
  vertices.resize(shape.vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = rotation * shape.vertices[i] + translation;
}

double separation_along(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& n) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vector3d& v : a.vertices) low = std::min(low, n.dot(v));
  for (const Vector3d& v : b.vertices) high = std::max(high, n.dot(v));
  return low - high;
}

PolytopeGap polytope_gap(const PlacedPolytope& a, const PlacedPolytope& b, double size) {
  const GjkResult found = gjk(a, b, size);
  PolytopeGap gap;
  gap.distance = 0.0;
  if (found.apart) {
    gap = from_simplex(a, b, found);
    if (gap.distance > kNearZone * size) return gap;
  }
  const BestAxis axis = best_separating_axis(a, b, size);
  if (!std::isfinite(axis.separation)) {  // two points
    if (!found.apart) gap = {0.0, a.vertices[0], b.vertices[0], Vector3d::UnitZ()};
    return gap;
  }
  // Corner against corner, or corner against edge: no axis of faces and edges measures their distance, the algorithm does.
  const double trusted = 1e-13 * size;
  if (found.apart && gap.distance > trusted && gap.distance > axis.separation * (1 + 1e-9)) return gap;
  gap.distance = axis.separation;
  gap.normal_b_to_a = axis.normal;
  gap.point_a = flat_hull(facing_region(a, b, axis.normal, kFacing * size), axis.normal).middle;
  gap.point_b = gap.point_a - axis.separation * axis.normal;
  return gap;
}

}  // namespace tumble::collision
