/// The first intersection of a ray with a surface, by a tree of bounding boxes. Watertight: no ray
/// passes through an edge or a vertex.
#pragma once

#include <optional>
#include <vector>

#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// Intersection of a ray with a face.
struct SurfaceHit {
  int face = -1;
  double t = kUnset;  // >= 0, in lengths of the ray's direction
  // (3), weights of the face's corners; sum 1, each in [0, 1]
  Vector3d barycentric{kUnset, kUnset, kUnset};
};

/// A surface prepared for queries by many rays.
/// Watertight: the side on which a ray passes an edge is computed from the same rounded numbers for
/// both faces at the edge, so that at least one of them is hit; boxes are widened by the rounding
/// of those numbers. A face that is parallel to the ray is not hit.
/// Source: S. Woop, C. Benthin, I. Wald, J. Computer Graphics Techniques 2(1), 2013, with double in
/// place of float.
class RayTree {
 public:
  /// @param mesh  at least one face; indices in range, coordinates finite
  /// Cost: O(n log n)
  explicit RayTree(TriangleMesh mesh);

  /// The nearest face on origin + t direction, 0 <= t <= t_most, from either side; of equal t the
  /// face of lowest index.
  /// @param origin, direction  (3), in the mesh's frame; direction finite, not zero, need not be
  ///     unit
  /// Cost: O(log n) for a surface that is spread out
  std::optional<SurfaceHit> nearest(const Vector3d& origin, const Vector3d& direction,
                                    double t_most = std::numeric_limits<double>::infinity()) const;

  const TriangleMesh& mesh() const { return mesh_; }

 private:
  struct Node {
    Vector3d low, high;
    // faces_[first, first + count) of a leaf; count is 0 for an inner node
    int first = 0, count = 0;
    int right = -1;  // the left child is the next node
  };
  struct Shear;

  int build(int first, int count, const std::vector<Vector3d>& middles);
  void try_face(int face, const Shear& shear, double t_most, std::optional<SurfaceHit>& best) const;

  TriangleMesh mesh_;
  std::vector<int> faces_;  // permuted: the faces of a leaf are adjacent
  std::vector<Node> nodes_;
};

}  // namespace tumble
