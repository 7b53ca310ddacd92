#include "framework/engines/contact/contact_geometry.h"

#include <algorithm>

#include "framework/collision/gap.h"
#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {

// Where forces act: on the surface of the body that moves, so that a rolling ball's arm is its
// radius; between two that move, in the middle.
Vector3d ContactGeometry::point_of(Pair pair, const collision::ManifoldPoint& p) const {
  if (moving_.world().bodies[pair.second].immovable()) return p.point_a_world;
  if (moving_.world().bodies[pair.first].immovable()) return p.point_b_world;
  return 0.5 * (p.point_a_world + p.point_b_world);
}

double ContactGeometry::friction(Pair pair) const {
  if (!built::kFriction) return 0.0;
  return std::min(moving_.world().bodies[pair.first].friction,
                  moving_.world().bodies[pair.second].friction);
}

bool ContactGeometry::is_inelastic(Pair pair) const {
  return std::min(moving_.world().bodies[pair.first].restitution,
                  moving_.world().bodies[pair.second].restitution) == 0.0;
}

double ContactGeometry::size_of(Pair pair) const {
  return std::min(moving_.shape(pair.first).bounding_radius(),
                  moving_.shape(pair.second).bounding_radius());
}

double ContactGeometry::margin(Pair pair) const {
  const double size = size_of(pair);
  const auto far = [&](int body) {
    return moving_.world().bodies[body].immovable()
               ? 0.0
               : moving_.state(body).com_world.cwiseAbs().maxCoeff();
  };
  return kContact.margin * size + kRoundOff * (size + std::max(far(pair.first), far(pair.second)));
}

collision::Pose ContactGeometry::pose(int body, const std::vector<RigidBodyState>& states) const {
  return {states[body].com_world, states[body].world_from_body};
}

ContactManifold ContactGeometry::points_at(Pair pair, const std::vector<RigidBodyState>& states,
                                           double reach) const {
  ContactManifold points = collision::manifold_points(
      moving_.shape(pair.first), pose(pair.first, states), moving_.shape(pair.second),
      pose(pair.second, states), reach, moving_.pair_cache(pair.first, pair.second));
  // Two that touch at corners may face each other along any direction, and a column along it may go
  // in at a narrow side and out at the far end: no point is deeper than the two are in each other.
  if (std::any_of(points.begin(), points.end(), [&](const collision::ManifoldPoint& p) {
        return p.gap < -kContact.deep * size_of(pair);
      })) {
    const collision::Gap deepest = gap_of(pair, states);
    std::erase_if(points, [&](const collision::ManifoldPoint& p) {
      return p.gap < std::min(0.0, (1 + kContact.depth_error) * deepest.distance);
    });
    if (points.empty() && deepest.distance <= reach)
      points.push_back({deepest.point_a_world, deepest.point_b_world, deepest.normal_b_to_a_world,
                        deepest.distance});
  }
  return points;
}

collision::Gap ContactGeometry::gap_of(Pair pair, const std::vector<RigidBodyState>& states) const {
  return collision::compute_gap(moving_.shape(pair.first), pose(pair.first, states),
                                moving_.shape(pair.second), pose(pair.second, states),
                                moving_.pair_cache(pair.first, pair.second));
}

// Above `limit` a bound from below.
double ContactGeometry::distance_of(Pair pair, const std::vector<RigidBodyState>& states,
                                    double limit) const {
  return collision::gap_distance(moving_.shape(pair.first), pose(pair.first, states),
                                 moving_.shape(pair.second), pose(pair.second, states),
                                 moving_.pair_cache(pair.first, pair.second), limit);
}

bool ContactGeometry::is_within(Pair pair, const std::vector<RigidBodyState>& states,
                                double reach) const {
  return collision::is_within(moving_.shape(pair.first), pose(pair.first, states),
                              moving_.shape(pair.second), pose(pair.second, states), reach,
                              moving_.pair_cache(pair.first, pair.second));
}

double ContactGeometry::least_gap_of(Pair pair, const std::vector<RigidBodyState>& states) const {
  return collision::least_gap(moving_.shape(pair.first), pose(pair.first, states),
                              moving_.shape(pair.second), pose(pair.second, states));
}

bool ContactGeometry::are_balls(Pair pair) const {
  return moving_.shape(pair.first).is_ball() && moving_.shape(pair.second).is_ball();
}

bool ContactGeometry::is_ball_on_edges(Pair pair) const {
  const auto has_edges = [&](int body) {
    const collision::CollisionShape& shape = moving_.shape(body);
    return !shape.is_ball() && !shape.is_half_space() && shape.ellipsoid() == nullptr;
  };
  return (moving_.shape(pair.first).is_ball() && has_edges(pair.second)) ||
         (moving_.shape(pair.second).is_ball() && has_edges(pair.first));
}

// A ball has one point on another, however far it has gone from where it was.
double ContactGeometry::same_within(Pair pair) const {
  return are_balls(pair) ? std::numeric_limits<double>::infinity()
                         : kContact.midway * size_of(pair);
}

// The point of `points` that is `p` at another time: fixed in one of the two bodies. None where
// none lies as near, or where its normal has turned farther than the bodies explain: that of a face
// stands still in its body, that of two edges turns with both. Where an edge has gone over a
// corner, the point of the next face lies as near as its own would.
ContactGeometry::SamePoint ContactGeometry::same_point(Pair pair, const collision::ManifoldPoint& p,
                                                       const std::vector<RigidBodyState>& p_at,
                                                       const ContactManifold& points,
                                                       const std::vector<RigidBodyState>& at,
                                                       double near) const {
  const RigidBodyState &a_then = p_at[pair.first], &b_then = p_at[pair.second],
                       &a_now = at[pair.first], &b_now = at[pair.second];
  const auto in = [](const RigidBodyState& s, const Vector3d& x) -> Vector3d {
    return s.world_from_body.conjugate() * (x - s.com_world);
  };
  const auto turn_in = [&](const RigidBodyState& then, const RigidBodyState& now,
                           const collision::ManifoldPoint& q) {
    return (then.world_from_body.conjugate() * p.normal_b_to_a_world -
            now.world_from_body.conjugate() * q.normal_b_to_a_world)
        .norm();
  };
  const double turned =
      (a_then.world_from_body.conjugate() * b_then.world_from_body)
          .angularDistance(a_now.world_from_body.conjugate() * b_now.world_from_body);
  // normals of a ball turn about its centre and about edges, however little it turns itself
  const double most_turn = are_balls(pair) || is_ball_on_edges(pair)
                               ? std::numeric_limits<double>::infinity()
                               : kSixDigits + kContact.midway_turn * turned;
  const auto ways_to = [&](const collision::ManifoldPoint& q) {
    return std::minmax({(in(a_then, p.point_a_world) - in(a_now, q.point_a_world)).norm(),
                        (in(b_then, p.point_b_world) - in(b_now, q.point_b_world)).norm()});
  };
  // where an edge turns on an edge every normal between the two faces is right
  const double at_pivot = (kSixDigits + kContact.pivot * turned) * size_of(pair);
  // of several that lie together, as in a groove, the one with its normal
  double nearest = near;
  for (const collision::ManifoldPoint& q : points) nearest = std::min(nearest, ways_to(q).first);
  double distance = std::min(near, 2 * nearest + kSixDigits * size_of(pair));
  SamePoint best;
  const collision::ManifoldPoint* turned_about = nullptr;
  for (const collision::ManifoldPoint& q : points) {
    const auto [way, longer_way] = ways_to(q);
    if (way >= distance) continue;
    const double turn = std::min(turn_in(a_then, a_now, q), turn_in(b_then, b_now, q));
    if (turn <= most_turn) {
      distance = way;
      best.point = &q;
    } else if (longer_way <= at_pivot) {
      turned_about = &q;
    } else {
      best.is_over_a_corner = best.is_over_a_corner || turn > kContact.most_turn;
    }
  }
  if (!best.point) best.point = turned_about;
  return best;
}

double ContactGeometry::large_island_margin(Pair pair) const {
  return kContact.large_island_margin * size_of(pair);
}

// Of two that overlap by `gap`: columns through their surfaces may go in and out elsewhere, deeper
// than the two are or not as deep.
ContactManifold ContactGeometry::points_of_overlap(Pair pair,
                                                   const std::vector<RigidBodyState>& states,
                                                   double reach, double gap) const {
  ContactManifold points = points_at(pair, states, reach);
  if (gap >= 0.0) return points;
  std::erase_if(points, [&](const collision::ManifoldPoint& p) {
    return p.gap < (1 + kContact.depth_error) * gap;
  });
  if (std::any_of(points.begin(), points.end(), [&](const collision::ManifoldPoint& p) {
        return p.gap < (1 - kContact.depth_error) * gap;
      }))
    return points;
  const collision::Gap deepest = gap_of(pair, states);
  points.push_back({deepest.point_a_world, deepest.point_b_world, deepest.normal_b_to_a_world,
                    deepest.distance});
  return points;
}

}  // namespace tumble::engines
