/// Where bodies touch: manifolds, gaps and margins of pairs, from places alone. It keeps nothing
/// but caches of the narrow phase.
///
/// Contacts are kept a margin apart, ContactConstants::margin of the smaller body and the rounding
/// of the bodies' places: gaps are never negative.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "framework/collision/manifold_points.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

/// The contact manifold of a pair: points at which its surfaces are near each other.
using ContactManifold = std::vector<collision::ManifoldPoint>;

class ContactGeometry {
 public:
  using Pair = std::pair<int, int>;  // bodies, first < second

  explicit ContactGeometry(MovingWorld& moving) : moving_(moving) {}

  /// Of the two, the smaller. [-]
  double friction(Pair pair) const;
  /// Whether the two do not bounce (perfectly inelastic).
  bool is_inelastic(Pair pair) const;
  bool are_balls(Pair pair) const;
  /// Whether one is a ball and the other has edges: about these the ball turns as about a ball.
  bool is_ball_on_edges(Pair pair) const;
  /// Radius about the smaller one. [m]
  double size_of(Pair pair) const;
  /// How far apart contacts are kept. [m]
  double margin(Pair pair) const;
  /// The same in large islands, whose problems are solved by a few sweeps. [m]
  double large_island_margin(Pair pair) const;

  // In these places (states by body index):
  collision::Pose pose(int body, const std::vector<RigidBodyState>& states) const;
  /// @param reach  points farther apart are not looked at [m]
  ContactManifold points_at(Pair pair, const std::vector<RigidBodyState>& states,
                            double reach) const;
  /// Of two that overlap by `gap` (< 0) or may come together: no point is deeper than the two are,
  /// and one is as deep.
  ContactManifold points_of_overlap(Pair pair, const std::vector<RigidBodyState>& states,
                                    double reach, double gap) const;
  collision::Gap gap_of(Pair pair, const std::vector<RigidBodyState>& states) const;
  /// @param limit  of larger gaps any bound from below will do [m]
  double distance_of(Pair pair, const std::vector<RigidBodyState>& states,
                     double limit = std::numeric_limits<double>::infinity()) const;
  /// Whether the gap is at most `reach` [m].
  bool is_within(Pair pair, const std::vector<RigidBodyState>& states, double reach) const;
  /// A bound from below, at once. [m]
  double least_gap_of(Pair pair, const std::vector<RigidBodyState>& states) const;
  bool overlap(Pair pair, const std::vector<RigidBodyState>& states) const {
    return least_gap_of(pair, states) < 0 && distance_of(pair, states, 0.0) < 0;
  }

  /// Where the force of a contact point acts. World frame. [m]
  Vector3d point_of(Pair pair, const collision::ManifoldPoint& point) const;
  /// How far the points of one contact may lie from each other at two instants of a step. [m]
  double same_within(Pair pair) const;
  /// A point of a contact at another instant.
  struct SamePoint {
    const collision::ManifoldPoint* point = nullptr;  // null: it is there no more
    bool is_over_a_corner = false;  // a point as near has the normal of another face or edge
  };
  /// The point of `points` that is `p` at another time: fixed in one of the two bodies, within
  /// `near` [m], on the same face or edges.
  SamePoint same_point(Pair pair, const collision::ManifoldPoint& p,
                       const std::vector<RigidBodyState>& p_at, const ContactManifold& points,
                       const std::vector<RigidBodyState>& at, double near) const;

 private:
  MovingWorld& moving_;
};

}  // namespace tumble::engines
