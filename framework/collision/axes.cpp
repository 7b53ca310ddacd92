#include "framework/collision/axes.h"

#include <algorithm>
#include <cmath>

#include "framework/collision/inline_vector.h"
#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// Edges at a smaller angle (rad) are parallel and define no axis: the axes of faces and other edges
// cover them.
constexpr double kParallel = 1e-9;
// An axis this close (rad) to a barred direction is that direction: far above the error of a cross
// product of edges at an angle of kParallel.
constexpr double kSameAxis = 1e-6;

// Keeps the best of the axes tested. Cheap rejections first: any known corner of A - B bounds the
// separation along every axis.
class Search {
 public:
  Search(const PlacedPolytope& a, const PlacedPolytope& b, double size,
         const BarredAxes* barred = nullptr)
      : a_(a), b_(b), handicap_(16 * kEpsilon * size), barred_(barred) {}

  void offer_face_of_a(int face) {
    const Vector3d m = a_.query_from_body * a_.polytope->face_normals[face];
    if (bounded(-m, 0.0)) return;
    const int j = b_.lowest(m);
    keep(-m, m.dot(b_.vertex(j) - a_.translation) - a_.polytope->face_offsets[face], 0.0, -1, j);
  }
  void offer_face_of_b(int face) {
    const Vector3d m = b_.query_from_body * b_.polytope->face_normals[face];
    if (bounded(m, 0.0)) return;
    const int i = a_.lowest(m);
    keep(m, m.dot(a_.vertex(i) - b_.translation) - b_.polytope->face_offsets[face], 0.0, i, -1);
  }
  // A face is preferred to an edge pair of equal separation: parallel faces touch along the faces'
  // normal.
  void offer_edges(const Vector3d& n) {
    if (bounded(n, handicap_)) return;
    const int i = a_.lowest(n), j = b_.lowest(-n);
    keep(n, n.dot(a_.vertex(i) - b_.vertex(j)), handicap_, i, j);
  }
  const Axis& best() const { return best_; }
  /// Whether a separation along n is known to be no better.
  bool bounded(const Vector3d& n, double handicap) const {
    return has_corner_ && n.dot(corner_) <= best_.separation + handicap;
  }
  bool too_low(double separation) const { return separation <= best_.separation + handicap_; }

 private:
  void keep(const Vector3d& n, double separation, double handicap, int i, int j) {
    if (!(separation > best_.separation + handicap)) return;
    if (barred_ && barred_->holds(n)) return;
    best_ = {separation, n};
    if (i < 0) i = a_.lowest(n);
    if (j < 0) j = b_.lowest(-n);
    corner_ = a_.vertex(i) - b_.vertex(j);
    has_corner_ = true;
  }

  const PlacedPolytope& a_;
  const PlacedPolytope& b_;
  double handicap_;
  const BarredAxes* barred_;
  Axis best_;
  bool has_corner_ = false;
  Vector3d corner_ = Vector3d::Zero();  // of A - B, foremost along the best axis
};

using Indices = InlineVector<int, 24>;

// Vertices at most `depth` above the lowest one along a direction.
void foremost(const PlacedPolytope& piece, const Vector3d& direction, double depth,
              Indices& vertices) {
  const Vector3d d = piece.in_body(direction);
  double lowest;
  piece.polytope->lowest(d, lowest);
  const auto& all = piece.polytope->vertices;
  for (int i = 0; i < static_cast<int>(all.size()); ++i)
    if (d.dot(all[i]) <= lowest + depth) vertices.push_back(i);
}

struct Edge {
  Vector3d direction, start;  // frame of the query; the direction is not a unit vector
};
using Edges = InlineVector<Edge, 32>;

void edges_between(const PlacedPolytope& piece, const Indices& vertices, Edges& edges) {
  const Polytope& p = *piece.polytope;
  for (const int i : vertices)
    for (int k = p.first_neighbour[i]; k < p.first_neighbour[i + 1]; ++k) {
      const int j = p.neighbours[k];
      if (j < i || std::find(vertices.begin(), vertices.end(), j) == vertices.end()) continue;
      edges.push_back({piece.query_from_body * (p.vertices[j] - p.vertices[i]), piece.vertex(i)});
    }
}

}  // namespace

bool BarredAxes::holds(const Vector3d& n) const {
  const auto same = [&](const std::optional<Vector3d>& direction) {
    return direction && (*direction - n).norm() < kSameAxis;
  };
  return same(first) || same(second);
}

Axis best_axis(const PlacedPolytope& a, const PlacedPolytope& b, double size,
               const BarredAxes* barred) {
  Search search(a, b, size, barred);
  for (int f = 0; f < static_cast<int>(a.polytope->face_normals.size()); ++f)
    search.offer_face_of_a(f);
  for (int f = 0; f < static_cast<int>(b.polytope->face_normals.size()); ++f)
    search.offer_face_of_b(f);
  InlineVector<Vector3d, 64> edges_b;
  for (const Vector3d& e : b.polytope->edge_directions) edges_b.push_back(b.query_from_body * e);
  for (const Vector3d& e : a.polytope->edge_directions) {
    const Vector3d edge_a = a.query_from_body * e;
    for (const Vector3d& edge_b : edges_b) {
      const Vector3d across = edge_a.cross(edge_b);
      const double sine = across.norm();
      if (sine < kParallel) continue;
      search.offer_edges(across / sine);
      search.offer_edges(-across / sine);
    }
  }
  return search.best();
}

std::vector<Vector3d> axes_apart(const PlacedPolytope& a, const PlacedPolytope& b,
                                 double separation) {
  std::vector<Vector3d> normals;
  const auto offer = [&](const Vector3d& n) {
    if (!(n.dot(a.vertex(a.lowest(n)) - b.vertex(b.lowest(-n))) >= separation)) return;
    if (std::none_of(normals.begin(), normals.end(),
                     [&](const Vector3d& known) { return (known - n).norm() < kSameAxis; }))
      normals.push_back(n);
  };
  for (const Vector3d& m : a.polytope->face_normals) offer(-(a.query_from_body * m));
  for (const Vector3d& m : b.polytope->face_normals) offer(b.query_from_body * m);
  for (const Vector3d& edge_a : a.polytope->edge_directions)
    for (const Vector3d& edge_b : b.polytope->edge_directions) {
      const Vector3d across = (a.query_from_body * edge_a).cross(b.query_from_body * edge_b);
      const double sine = across.norm();
      if (sine < kParallel) continue;
      offer(across / sine);
      offer(-across / sine);
    }
  return normals;
}

Axis best_axis_near(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& direction,
                    double angle, double size) {
  Search search(a, b, size);
  const double least = 1.0 - 0.5 * angle * angle;
  const auto offer_faces = [&](const PlacedPolytope& piece, const Vector3d& outward, auto&& offer) {
    const Vector3d d = piece.in_body(outward);
    const auto& normals = piece.polytope->face_normals;
    for (int f = 0; f < static_cast<int>(normals.size()); ++f)
      if (normals[f].dot(d) >= least) offer(f);
  };
  offer_faces(a, -direction, [&](int f) { search.offer_face_of_a(f); });
  offer_faces(b, direction, [&](int f) { search.offer_face_of_b(f); });

  const double depth = 2 * angle * size;
  Indices of_a, of_b;
  foremost(a, direction, depth, of_a);
  if (of_a.size() < 2) return search.best();
  foremost(b, -direction, depth, of_b);
  if (of_b.size() < 2) return search.best();
  Edges edges_a, edges_b;
  edges_between(a, of_a, edges_a);
  edges_between(b, of_b, edges_b);
  for (const Edge& ea : edges_a) {
    for (const Edge& eb : edges_b) {
      const Vector3d across = ea.direction.cross(eb.direction);
      const double squared = across.squaredNorm();
      if (!(squared >
            kParallel * kParallel * ea.direction.squaredNorm() * eb.direction.squaredNorm()))
        continue;
      const double length = std::sqrt(squared);
      const Vector3d n = across / (across.dot(direction) < 0 ? -length : length);
      // The edges belong to A and B: the solids' separation along n is not larger than that of the
      // edges.
      if (search.too_low(n.dot(ea.start - eb.start))) continue;
      search.offer_edges(n);
    }
  }
  return search.best();
}

}  // namespace tumble::collision
