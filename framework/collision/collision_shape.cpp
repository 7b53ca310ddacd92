#include "framework/collision/collision_shape.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace tumble::collision {
namespace {

// Directions closer than this (rad) are merged: coplanar faces, parallel edges. Far above the
// rounding of a unit vector, far below the angles in models; a direction dropped wrongly changes a
// gap by the size times the square of this.
constexpr double kSameDirection = 1e-10;

void add_direction(std::vector<Vector3d>& directions, Vector3d direction, bool both_senses) {
  const double length = direction.norm();
  if (!(length > 0)) return;
  direction /= length;
  for (const Vector3d& known : directions) {
    if ((known - direction).norm() < kSameDirection ||
        (both_senses && (known + direction).norm() < kSameDirection))
      return;
  }
  directions.push_back(direction);
}

Polytope box_polytope(const Vector3d& h) {
  Polytope box;
  for (const int x : {-1, 1})
    for (const int y : {-1, 1})
      for (const int z : {-1, 1}) box.vertices.emplace_back(x * h.x(), y * h.y(), z * h.z());
  for (int axis = 0; axis < 3; ++axis) {
    box.edge_directions.push_back(Vector3d::Unit(axis));
    box.face_normals.push_back(Vector3d::Unit(axis));
    box.face_normals.push_back(-Vector3d::Unit(axis));
  }
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if (!(i & bit)) box.edges.emplace_back(i, i | bit);
  return box;
}

Vector3d across(const TriangleMesh& mesh, const Face& face) {
  const Vector3d& a = mesh.vertices[face[0]];
  return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a);
}

Polytope hull_polytope(const TriangleMesh& mesh) {
  Polytope hull;
  hull.vertices = mesh.vertices;
  std::map<std::pair<int, int>, Vector3d> normal_beside;  // by directed edge
  for (const Face& face : mesh.faces) {
    const Vector3d n = across(mesh, face).normalized();
    add_direction(hull.face_normals, n, false);
    for (int i = 0; i < 3; ++i) normal_beside[{face[i], face[(i + 1) % 3]}] = n;
  }
  for (const auto& [edge, n] : normal_beside) {
    if (edge.first > edge.second) continue;
    const auto other = normal_beside.find({edge.second, edge.first});
    // A diagonal between coplanar triangles is not an edge of the solid.
    if (other != normal_beside.end() && (other->second - n).norm() < kSameDirection) continue;
    hull.edges.push_back(edge);
    add_direction(hull.edge_directions, mesh.vertices[edge.second] - mesh.vertices[edge.first],
                  true);
  }
  return hull;
}

Polytope triangle_polytope(const TriangleMesh& mesh, const Face& face) {
  Polytope piece;
  for (const int i : face) piece.vertices.push_back(mesh.vertices[i]);
  const Vector3d n = across(mesh, face).normalized();
  const bool flat = n.allFinite() && n.squaredNorm() > 0;
  if (flat) piece.face_normals = {n, -n};
  piece.is_face = flat;
  for (int i = 0; i < 3; ++i) {
    const Vector3d edge = piece.vertices[(i + 1) % 3] - piece.vertices[i];
    add_direction(piece.edge_directions, edge, true);
    piece.edges.emplace_back(i, (i + 1) % 3);
    // normal of the triangle's side, in its plane
    if (flat) add_direction(piece.face_normals, edge.cross(n), false);
  }
  return piece;
}

}  // namespace

CollisionShape::CollisionShape(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    Polytope point;
    point.vertices = {Vector3d::Zero()};
    pieces_.push_back(std::move(point));
    radius_ = sphere->radius;
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    pieces_.push_back(box_polytope(box->half_extents_body));
  } else if (const auto* curved = std::get_if<Ellipsoid>(&shape)) {
    ellipsoid_ = *curved;
    pieces_.push_back(box_polytope(curved->semi_axes_body));
    for (Vector3d& corner : pieces_.back().vertices) corner += curved->center_body;
  } else if (const auto* solid = std::get_if<MeshSolid>(&shape)) {
    if (solid->is_convex) {
      pieces_.push_back(hull_polytope(solid->mesh_body));
    } else {
      for (const Face& face : solid->mesh_body.faces)
        pieces_.push_back(triangle_polytope(solid->mesh_body, face));
      faces_ = solid->mesh_body.faces;
      neighbours_.resize(solid->mesh_body.vertices.size());
      for (const Face& face : faces_)
        // a closed surface has each edge once in either direction
        for (int i = 0; i < 3; ++i) neighbours_[face[i]].push_back(face[(i + 1) % 3]);
    }
    vertices_ = solid->mesh_body.vertices;
  } else {
    bounding_radius_ = std::numeric_limits<double>::infinity();
    return;
  }
  for (Polytope& piece : pieces_) piece.prepare();
  if (vertices_.empty()) vertices_ = pieces_[0].vertices;
  for (const Vector3d& v : vertices_) bounding_radius_ = std::max(bounding_radius_, v.norm());
  bounding_radius_ += radius_;
  corners_.vertices = vertices_;
  corners_.prepare();
  std::vector<int> order(pieces_.size());
  std::iota(order.begin(), order.end(), 0);
  build_node(order, 0, static_cast<int>(order.size()));
}

int CollisionShape::build_node(std::vector<int>& order, int begin, int end) {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (int i = begin; i < end; ++i)
    for (const Vector3d& v : pieces_[order[i]].vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
  BallNode node;
  node.center_body = 0.5 * (low + high);
  node.half_extents_body = 0.5 * (high - low);
  node.radius = 0.0;
  for (int i = begin; i < end; ++i)
    for (const Vector3d& v : pieces_[order[i]].vertices)
      node.radius = std::max(node.radius, (v - node.center_body).norm());
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back(node);
  if (end - begin == 1) {
    nodes_[index].piece = order[begin];
    return index;
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle_of = [&](int piece) {
    double sum = 0.0;
    for (const Vector3d& v : pieces_[piece].vertices) sum += v[axis];
    return sum / static_cast<double>(pieces_[piece].vertices.size());
  };
  const int middle = (begin + end) / 2;
  std::sort(order.begin() + begin, order.begin() + end, [&](int a, int b) {
    const double ma = middle_of(a), mb = middle_of(b);
    return ma != mb ? ma < mb : a < b;
  });
  const int first = build_node(order, begin, middle);
  const int second = build_node(order, middle, end);
  nodes_[index].first_child = first;
  nodes_[index].second_child = second;
  return index;
}

bool CollisionShape::holds_point(const Vector3d& point_body) const {
  if (!is_closed_surface()) return false;
  // Sum of the solid angles of all faces: 4 pi inside, 0 outside.
  // Source: A. Van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
  double angle = 0.0;
  for (const Polytope& piece : pieces_) {
    const Vector3d a = piece.vertices[0] - point_body, b = piece.vertices[1] - point_body,
                   c = piece.vertices[2] - point_body;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2.0 * std::numbers::pi;
}

}  // namespace tumble::collision
