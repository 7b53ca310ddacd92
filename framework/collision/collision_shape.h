/// A solid prepared for collision detection: convex pieces with a rounding radius, and a
/// bounding-volume tree over them.
///
/// Sphere: one point and its radius. Box and convex model: one polytope. Other models: one flat
/// piece per face, so that a pair of solids is a set of pairs of convex pieces, for which bounds on
/// the time of impact exist. A half-space has no pieces; every other shape is tested against it by
/// its vertices. Ellipsoid: a curved surface that collides with half-spaces only (ellipsoid.h); its
/// piece and its vertices are those of its bounding box.
#pragma once

#include <optional>
#include <vector>

#include "framework/collision/polytope.h"
#include "framework/geometry/shape.h"

namespace tumble::collision {

/// Position and orientation of a body. World frame.
struct Pose {
  Vector3d com_world = Vector3d::Zero();                  // [m]
  Quaterniond world_from_body = Quaterniond::Identity();  // unit
};

/// A ball and a box around some of the pieces, with a common centre.
struct BallNode {
  Vector3d center_body;
  double radius;
  // of the box, with edges along the body's axes [m]
  Vector3d half_extents_body = Vector3d::Zero();
  int first_child = -1;  // -1: a leaf
  int second_child = -1;
  int piece = -1;
};

class CollisionShape {
 public:
  explicit CollisionShape(const Shape& shape);

  bool is_half_space() const { return pieces_.empty(); }
  bool is_ball() const { return pieces_.size() == 1 && pieces_[0].vertices.size() == 1; }
  bool is_closed_surface() const { return pieces_.size() > 1; }
  // null: not an ellipsoid
  const Ellipsoid* ellipsoid() const { return ellipsoid_ ? &*ellipsoid_ : nullptr; }
  /// Rounding radius around the pieces. [m]
  double radius() const { return radius_; }
  /// Radius of the smallest ball about the centre of mass that contains the solid; infinite for a
  /// half-space. [m]
  double bounding_radius() const { return bounding_radius_; }
  const std::vector<Polytope>& pieces() const { return pieces_; }
  const std::vector<BallNode>& nodes() const { return nodes_; }  // the first is the root
  const std::vector<Vector3d>& vertices() const { return vertices_; }
  /// All vertices as one polytope without faces, for tests against a half-space.
  const Polytope& corners() const { return corners_; }
  /// For a solid of flat pieces: the vertices of a piece, and the vertices that share an edge with
  /// a vertex.
  const Face& vertices_of_piece(int piece) const { return faces_[piece]; }
  const std::vector<int>& neighbours(int vertex) const { return neighbours_[vertex]; }
  /// Whether a solid of flat pieces contains the point.
  bool holds_point(const Vector3d& point_body) const;

 private:
  int build_node(std::vector<int>& order, int begin, int end);

  std::vector<Polytope> pieces_;
  std::vector<BallNode> nodes_;
  std::vector<Vector3d> vertices_;
  Polytope corners_;
  std::vector<Face> faces_;  // of a solid of flat pieces
  std::vector<std::vector<int>> neighbours_;
  std::optional<Ellipsoid> ellipsoid_;
  double radius_ = 0.0;
  double bounding_radius_ = 0.0;
};

}  // namespace tumble::collision
