/// Walks the pairs of convex pieces of two solids, nearest balls first. Internal to collision.
#pragma once

#include <algorithm>
#include <vector>

#include "framework/collision/gap.h"

namespace tumble::collision {

/// Two solids in the frame of a query: origin at B's centre of mass, axes of the world, so that a pair far from the world's
/// origin loses no digits.
struct Query {
  const CollisionShape& a;
  const CollisionShape& b;
  Matrix3d rotation_a, rotation_b;
  Vector3d offset;   // centre of A minus centre of B [m]
  double size;       // [m]

  Query(const CollisionShape& shape_a, const Pose& pose_a, const CollisionShape& shape_b, const Pose& pose_b)
      : a(shape_a), b(shape_b), rotation_a(pose_a.world_from_body.toRotationMatrix()),
        rotation_b(pose_b.world_from_body.toRotationMatrix()), offset(pose_a.com_world - pose_b.com_world),
        size(offset.norm() + (a.is_half_space() ? 0.0 : a.bounding_radius()) + (b.is_half_space() ? 0.0 : b.bounding_radius())) {}

  PlacedPolytope piece_of_a(int i) const { return {&a.pieces()[i], rotation_a, offset}; }
  PlacedPolytope piece_of_b(int j) const { return {&b.pieces()[j], rotation_b, Vector3d::Zero()}; }
};

/// Calls visit(piece_a, piece_b) for every pair of pieces that skip(lower bound of their cores' distance) does not rule out.
/// @pre neither solid is a half-space
template <class Skip, class Visit>
void visit_piece_pairs(const Query& query, Skip&& skip, Visit&& visit) {
  struct Entry { double bound; int node_a, node_b; };
  const auto& nodes_a = query.a.nodes();
  const auto& nodes_b = query.b.nodes();
  const auto entry = [&](int i, int j) {
    const Vector3d between = query.offset + query.rotation_a * nodes_a[i].center_body - query.rotation_b * nodes_b[j].center_body;
    return Entry{between.norm() - nodes_a[i].radius - nodes_b[j].radius, i, j};
  };
  std::vector<Entry> stack{entry(0, 0)};
  while (!stack.empty()) {
    const Entry top = stack.back();
    stack.pop_back();
    if (skip(top.bound)) continue;
    const BallNode& a = nodes_a[top.node_a];
    const BallNode& b = nodes_b[top.node_b];
    if (a.piece >= 0 && b.piece >= 0) {
      visit(a.piece, b.piece);
      continue;
    }
    // The larger ball is opened; the nearer of its two children is looked at first.
    const bool open_a = b.piece >= 0 || (a.piece < 0 && a.radius >= b.radius);
    Entry first = open_a ? entry(a.first_child, top.node_b) : entry(top.node_a, b.first_child);
    Entry second = open_a ? entry(a.second_child, top.node_b) : entry(top.node_a, b.second_child);
    if (second.bound < first.bound) std::swap(first, second);
    stack.push_back(second);
    stack.push_back(first);
  }
}

}  // namespace tumble::collision
