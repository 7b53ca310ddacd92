#include "framework/collision/edge_on_edge.h"

#include <algorithm>
#include <cmath>

#include "framework/collision/inline_vector.h"

namespace tumble::collision {
namespace {

// Relative to the size: edges this close lie on each other. Models store coordinates in single
// precision, with an error of 1e-7.
constexpr double kNear = 1e-6;
// Relative to the size: a vertex this close to a face's plane is one of its corners.
constexpr double kOnFace = 1e-9;
// rad: a narrower range of normals counts as a single normal.
constexpr double kSingleNormal = 1e-9;

using Indices = InlineVector<int, 8>;

Indices foremost(const PlacedPolytope& piece, const Vector3d& towards_inside, double depth) {
  const Vector3d d = piece.in_body(towards_inside);
  double lowest;
  const int first = piece.polytope->lowest(d, lowest);
  Indices found;
  const auto& vertices = piece.polytope->vertices;
  for (int i = 0; i < piece.size(); ++i)
    if (i == first || d.dot(vertices[i]) <= lowest + depth) found.push_back(i);
  return found;
}

struct Edge {
  int from, to;
  Vector3d start, along;  // frame of the query; `along` is not a unit vector
};
using Edges = InlineVector<Edge, 8>;

Edges edges_between(const PlacedPolytope& piece, const Indices& corners) {
  Edges edges;
  const Polytope& p = *piece.polytope;
  for (const int i : corners)
    for (int k = p.first_neighbour[i]; k < p.first_neighbour[i + 1]; ++k)
      if (const int j = p.neighbours[k];
          j > i && std::find(corners.begin(), corners.end(), j) != corners.end())
        edges.push_back(
            {i, j, piece.vertex(i), piece.query_from_body * (p.vertices[j] - p.vertices[i])});
  return edges;
}

// Whether the edges are closer than `near` along a common segment, whose ends are stored in
// `shared`.
bool lie_along(const Edge& a, const Edge& b, double near, EdgeOnEdge& shared) {
  const double length = a.along.squaredNorm();
  const auto place = [&](const Vector3d& point) { return a.along.dot(point - a.start) / length; };
  const double first = place(b.start), second = place(b.start + b.along);
  const double low = std::max(0.0, std::min(first, second)),
               high = std::min(1.0, std::max(first, second));
  if (!((high - low) * std::sqrt(length) > near)) return false;
  for (const std::size_t end : {0, 1}) {
    const double t = end == 0 ? low : high, u = (t - first) / (second - first);
    shared.on_a[end] = a.start + t * a.along;
    shared.on_b[end] = b.start + u * b.along;
    if (!((shared.on_a[end] - shared.on_b[end]).norm() <= near)) return false;
  }
  return true;
}

double angle_about(const Vector3d& edge, const Vector3d& from, const Vector3d& to) {
  return std::atan2(edge.dot(from.cross(to)), from.dot(to));
}

/// The normal cone of an edge: the normals of its faces, less than 180 degrees about it. `side` +1:
/// outward, -1: inward.
struct Cone {
  Vector3d middle = Vector3d::Zero();  // mean of its normals; zero: no faces
  double low = 0.0, high = 0.0;        // rad about the edge, from `middle`
};

Cone cone_of(const PlacedPolytope& piece, const Edge& edge, double side, const Vector3d& along,
             double size) {
  const Polytope& p = *piece.polytope;
  InlineVector<Vector3d, 8> normals;
  Cone cone;
  for (std::size_t f = 0; f < p.face_normals.size(); ++f) {
    const Vector3d& m = p.face_normals[f];
    const double lowest = p.face_offsets[f] - kOnFace * size;
    if (m.dot(p.vertices[edge.from]) < lowest || m.dot(p.vertices[edge.to]) < lowest) continue;
    normals.push_back(side * (piece.query_from_body * m));
    cone.middle += normals[normals.size() - 1];
  }
  for (const Vector3d& normal : normals) {
    const double angle = angle_about(along, cone.middle, normal);
    cone.low = std::min(cone.low, angle);
    cone.high = std::max(cone.high, angle);
  }
  return cone;
}

// The middle of the intersection of two cones about an edge. The GJK direction is not used: for
// touching edges it is only rounding.
std::optional<Vector3d> middle_of_both(const Cone& a, const Cone& b, const Vector3d& along) {
  if (a.middle.isZero(0.0) || b.middle.isZero(0.0)) return std::nullopt;
  const double aside = angle_about(along, a.middle, b.middle);
  const double low = std::max(a.low, aside + b.low), high = std::min(a.high, aside + b.high);
  if (!(high - low > kSingleNormal)) return std::nullopt;
  return Eigen::AngleAxisd(0.5 * (low + high), along) *
         (a.middle - a.middle.dot(along) * along).normalized();
}

}  // namespace

std::optional<EdgeOnEdge> edge_on_edge(const PlacedPolytope& a, const PlacedPolytope& b,
                                       const Vector3d& n, double size) {
  const double near = kNear * size;
  const Indices of_a = foremost(a, n, near), of_b = foremost(b, -n, near);
  // a corner on either side, or face on face
  if (of_a.size() < 2 || of_b.size() < 2 || (of_a.size() > 2 && of_b.size() > 2))
    return std::nullopt;
  const Edges edges_a = edges_between(a, of_a), edges_b = edges_between(b, of_b);
  for (const Edge& edge_a : edges_a)
    for (const Edge& edge_b : edges_b) {
      EdgeOnEdge shared;
      if (!lie_along(edge_a, edge_b, near, shared)) continue;
      const Vector3d along = edge_a.along.normalized();
      const auto normal = middle_of_both(cone_of(a, edge_a, -1.0, along, size),
                                         cone_of(b, edge_b, 1.0, along, size), along);
      if (!normal || separation_along(a, b, *normal) < -2 * near) continue;
      shared.normal_b_to_a = *normal;
      return shared;
    }
  return std::nullopt;
}

}  // namespace tumble::collision
