// The forest that links make of bodies.
#include "framework/dynamics/articulated_tree.h"

#include <algorithm>
#include <numeric>

#include "framework/core/disjoint_sets.h"
#include "framework/core/error.h"

namespace tumble {
namespace {

// The pair (places, velocities) is never as long as a list of packed bodies, by which a symplectic
// method would know places from momenta (methods.h).
constexpr int kPacked = 13;

/// Of the freedoms between two bodies, how many the link takes.
int freedoms_taken(TreeJoint kind) {
  switch (kind) {
    case TreeJoint::kFree: return 0;
    case TreeJoint::kRod: return 1;
    case TreeJoint::kBall: return 3;
    case TreeJoint::kHinge: return 5;
    case TreeJoint::kWeld: return 6;
  }
  return 0;
}

}  // namespace

ArticulatedTree::ArticulatedTree(const std::vector<Inertia>& bodies, int fixed_ends,
                                 const std::vector<TreeLink>& links)
    : nodes_(bodies.size()),
      motions_(bodies.size() + static_cast<std::size_t>(fixed_ends)),
      held_(bodies.size()),
      solved_(motions_.size()) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    require(bodies[i].inverse_mass > 0.0, "a body of an articulated tree can move");
    nodes_[i].mass = bodies[i].mass;
    nodes_[i].inertia_body = bodies[i].inertia_body;
    nodes_[i].inverse_inertia_body = bodies[i].inertia_body.inverse();
    const double moment = bodies[i].inertia_body(0, 0);
    nodes_[i].is_even = bodies[i].inertia_body == moment * Matrix3d::Identity();
    nodes_[i].is_principal = bodies[i].inertia_body.isDiagonal(0.0);
  }
  hang(bodies, links);
  find_points(links);
  assign_numbers();
}

// Kruskal's forest, links that take most freedom first; all fixed ends are one ground.
void ArticulatedTree::hang(const std::vector<Inertia>& bodies, const std::vector<TreeLink>& links) {
  const int n = movable(), ground = n;
  const auto end = [&](int place) { return std::min(place, ground); };
  std::vector<int> by_freedom(links.size());
  std::iota(by_freedom.begin(), by_freedom.end(), 0);
  std::stable_sort(by_freedom.begin(), by_freedom.end(), [&](int i, int j) {
    return freedoms_taken(links[static_cast<std::size_t>(i)].kind) >
           freedoms_taken(links[static_cast<std::size_t>(j)].kind);
  });
  DisjointSets sets(n + 1);
  std::vector<std::vector<int>> links_of(bodies.size() + 1);  // kept, by end
  for (const int k : by_freedom) {
    const TreeLink& link = links[static_cast<std::size_t>(k)];
    const int a = end(link.a), b = end(link.b);
    if (sets.find(a) == sets.find(b)) {
      cut_.push_back(k);
      continue;
    }
    sets.unite(a, b);
    links_of[static_cast<std::size_t>(a)].push_back(k);
    links_of[static_cast<std::size_t>(b)].push_back(k);
  }
  std::sort(cut_.begin(), cut_.end());
  // From the ground, then from the heaviest body of what is left, breadth first.
  std::vector<int> roots(bodies.size());
  std::iota(roots.begin(), roots.end(), 0);
  std::stable_sort(roots.begin(), roots.end(), [&](int i, int j) {
    return bodies[static_cast<std::size_t>(i)].mass > bodies[static_cast<std::size_t>(j)].mass;
  });
  roots.insert(roots.begin(), ground);
  std::vector<int> depth(bodies.size() + 1, -1);
  for (const int root : roots) {
    if (depth[static_cast<std::size_t>(root)] >= 0) continue;
    depth[static_cast<std::size_t>(root)] = 0;
    std::vector<int> reached{root};
    if (root != ground) order_.push_back(root);
    for (std::size_t at = 0; at < reached.size(); ++at)
      for (const int k : links_of[static_cast<std::size_t>(reached[at])]) {
        const TreeLink& link = links[static_cast<std::size_t>(k)];
        const bool a_is_parent = end(link.a) == reached[at];
        const int child = end(a_is_parent ? link.b : link.a);
        if (depth[static_cast<std::size_t>(child)] >= 0) continue;
        depth[static_cast<std::size_t>(child)] = depth[static_cast<std::size_t>(reached[at])] + 1;
        depth_ = std::max(depth_, depth[static_cast<std::size_t>(child)]);
        reached.push_back(child);
        order_.push_back(child);
        Node& node = nodes_[static_cast<std::size_t>(child)];
        node.kind = link.kind;
        node.link = k;
        node.parent = a_is_parent ? link.a : link.b;
        node.point_parent = a_is_parent ? link.point_a_body : link.point_b_body;
        node.point_own = a_is_parent ? link.point_b_body : link.point_a_body;
        node.length = link.length;
        node.parent_from_joint = a_is_parent ? link.a_from_joint : link.b_from_joint;
        node.axis_parent = node.parent_from_joint * Vector3d::UnitZ();
        node.joint_from_own = (a_is_parent ? link.b_from_joint : link.a_from_joint).conjugate();
      }
  }
}

void ArticulatedTree::find_points(const std::vector<TreeLink>& links) {
  size_ = 0.0;
  for (Node& node : nodes_) {
    node.at_own_centre = node.point_own.isZero(0.0);
    node.at_parent_centre = node.point_parent.isZero(0.0);
    const bool keeps_turning = node.kind == TreeJoint::kBall || node.kind == TreeJoint::kRod ||
                               node.kind == TreeJoint::kFree;
    node.is_point = keeps_turning && (node.kind == TreeJoint::kFree || node.at_own_centre);
  }
  for (const Node& node : nodes_) {
    size_ = std::max({size_, node.length, node.point_own.norm(), node.point_parent.norm()});
    if (node.parent < 0 || node.parent >= movable()) continue;
    const bool at_centre =
        node.at_parent_centre && (node.kind == TreeJoint::kBall || node.kind == TreeJoint::kRod);
    if (!at_centre) nodes_[static_cast<std::size_t>(node.parent)].is_point = false;
  }
  if (size_ == 0.0) size_ = 1.0;
  for (Node& node : nodes_) node.may_turn_evenly = node.is_even && node.is_point;
  for (const int cut : cut_) {
    const TreeLink& link = links[static_cast<std::size_t>(cut)];
    const bool turns = link.kind == TreeJoint::kBall || link.kind == TreeJoint::kRod;
    if (link.a < movable() && !(turns && link.point_a_body.isZero(0.0)))
      nodes_[static_cast<std::size_t>(link.a)].may_turn_evenly = false;
    if (link.b < movable() && !(turns && link.point_b_body.isZero(0.0)))
      nodes_[static_cast<std::size_t>(link.b)].may_turn_evenly = false;
  }
}

void ArticulatedTree::assign_numbers() {
  half_ = 0;
  for (const int place : order_) {
    Node& node = nodes_[static_cast<std::size_t>(place)];
    node.at = half_;
    if (node.kind == TreeJoint::kFree || node.kind == TreeJoint::kRod) half_ += 3;
    if (node.kind == TreeJoint::kHinge) half_ += 1;
    const bool has_turning = node.kind != TreeJoint::kHinge && node.kind != TreeJoint::kWeld;
    if (has_turning && !node.turns_evenly) half_ += 4;
  }
  if (half_ == 0 || 2 * half_ % kPacked == 0) ++half_;
}

}  // namespace tumble
