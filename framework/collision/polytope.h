/// A convex polytope prepared once for questions about it, and where it stands now. Knows points only: no radii.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "framework/core/math.h"

namespace tumble::collision {

/// The convex hull of a few points, with the directions that can separate it from another. Body frame.
struct Polytope {
  std::vector<Vector3d> vertices;          // at least one [m]
  std::vector<Vector3d> face_normals;      // unit, outward; a flat triangle has both sides and its three rims
  std::vector<Vector3d> edge_directions;   // unit, each direction once
  std::vector<std::pair<int, int>> edges;  // of vertices, each once

  // Worked out from these by `prepare`.
  using Lanes = double __attribute__((vector_size(16)));
  using Columns = std::array<Lanes, 3>;     // x, y and z of two vertices: one instruction works on both
  std::vector<Columns> columns;            // the last vertex again up to a multiple of four
  std::vector<double> arms;                // distance of each vertex from the origin [m]
  std::vector<double> face_offsets;        // largest normal . vertex [m]
  std::vector<int> first_neighbour;        // neighbours of vertex i: from first_neighbour[i] to first_neighbour[i + 1]
  std::vector<int> neighbours;

  void prepare();
  /// The vertex that lies lowest along a direction, of equal ones the first. @param height  where it lies [m]
  int lowest(const Vector3d& direction, double& height) const;

 private:
  int lowest_of_many(const Vector3d& direction, double& height) const;
};

/// A polytope where it stands now, in the frame of a query.
struct PlacedPolytope {
  const Polytope* polytope;
  Matrix3d query_from_body;
  Vector3d translation;

  Vector3d vertex(int i) const { return query_from_body * polytope->vertices[i] + translation; }
  int size() const { return static_cast<int>(polytope->vertices.size()); }
  Vector3d in_body(const Vector3d& d) const { return {query_from_body.col(0).dot(d), query_from_body.col(1).dot(d), query_from_body.col(2).dot(d)}; }
  /// Index of the vertex that lies lowest along a direction.
  int lowest(const Vector3d& direction) const {
    double height;
    return polytope->lowest(in_body(direction), height);
  }
  double lowest_height(const Vector3d& direction) const {
    double height;
    polytope->lowest(in_body(direction), height);
    return height + direction.dot(translation);
  }
};

/// min over A of n.a minus max over B of n.b: how far the two lie apart along `n`. [m]
double separation_along(const PlacedPolytope& a, const PlacedPolytope& b, const Vector3d& normal_b_to_a);

}  // namespace tumble::collision
