/// A convex polytope prepared for queries, and the same in its current pose. Without rounding
/// radius.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "framework/core/math.h"

namespace tumble::collision {

/// The convex hull of a few points, with its possible separating axes. Body frame.
struct Polytope {
  std::vector<Vector3d> vertices;  // at least one [m]
  // unit, outward; a flat triangle has its two faces and its three sides
  std::vector<Vector3d> face_normals;
  // a face of a solid's surface: the first of its normals points out of the solid
  bool is_face = false;
  std::vector<Vector3d> edge_directions;   // unit, each direction once
  std::vector<std::pair<int, int>> edges;  // of vertices, each once

  // Computed from these by `prepare`.
  static constexpr int kLanes = 4;
  static constexpr std::size_t kMostColumns = 32;  // of polytopes whose vertices are looked at so
  // x, then y, then z of four vertices, and so on, for SIMD instructions; padded with the last
  std::vector<double> columns;
  std::vector<double> arms;          // distance of each vertex from the origin [m]
  std::vector<double> face_offsets;  // largest normal . vertex [m]
  std::vector<double> face_columns;  // likewise: of four normals, then of their offsets
  // neighbours of vertex i: from first_neighbour[i] to first_neighbour[i + 1]
  std::vector<int> first_neighbour;
  std::vector<int> neighbours;

  void prepare();
  /// The lowest vertex along a direction; of equal ones the first.
  /// @param height  [out] its height [m]
  int lowest(const Vector3d& direction, double& height) const;
  /// Only the height of the lowest vertex. [m]
  double lowest_height(const Vector3d& direction) const;
  /// How far along a direction a line from a point has entered the half-spaces of all faces that
  /// look against it, their cosine to it at most -`steep`; -infinity without any. [m]
  double entry_along(const Vector3d& direction, const Vector3d& point, double steep) const;

 private:
  int lowest_of_many(const Vector3d& direction, double& height) const;
};

/// A polytope in its current pose, in the frame of a query.
struct PlacedPolytope {
  const Polytope* polytope;
  Matrix3d query_from_body;
  Vector3d translation;

  Vector3d vertex(int i) const { return query_from_body * polytope->vertices[i] + translation; }
  int size() const { return static_cast<int>(polytope->vertices.size()); }
  Vector3d in_body(const Vector3d& d) const {
    return {query_from_body.col(0).dot(d), query_from_body.col(1).dot(d),
            query_from_body.col(2).dot(d)};
  }
  /// Index of the lowest vertex along a direction.
  int lowest(const Vector3d& direction) const {
    double height;
    return polytope->lowest(in_body(direction), height);
  }
  double lowest_height(const Vector3d& direction) const {
    return polytope->lowest_height(in_body(direction)) + direction.dot(translation);
  }
};

/// Separation along `n`: min over A of n.a minus max over B of n.b. [m]
double separation_along(const PlacedPolytope& a, const PlacedPolytope& b,
                        const Vector3d& normal_b_to_a);

}  // namespace tumble::collision
