#include "framework/collision/time_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/collision/edge_bound.h"
#include "framework/collision/ellipsoid.h"
#include "framework/collision/frame_bound.h"
#include "framework/collision/piece_pairs.h"
#include "framework/collision/vertex_lines.h"
#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// Lines of all vertices of a piece of a body. `side` is +1 for A (heights along n) and -1 for B
// (heights along -n).
void collect_lines(const PlacedPolytope& piece, const MotionState& state,
                   const MotionBounds& bounds, const Vector3d& n, double side, VertexLines& lines) {
  lines.clear();
  const Polytope& p = *piece.polytope;
  const double half_acceleration_of_arm = 0.5 * acceleration_by_rotation(bounds);
  // n . (w x r) = (n x w) . r
  const Vector3d up = piece.in_body(side * n),
                 turn = piece.in_body(side * n.cross(state.omega_world));
  double lowest;
  p.lowest(up, lowest);
  for (int i = 0; i < piece.size(); ++i)
    lines.push_back({up.dot(p.vertices[i]) - lowest,
                     turn.dot(p.vertices[i]) - bounds.angular_velocity_error * p.arms[i],
                     half_acceleration_of_arm * p.arms[i]});
}

double lowest_at(const VertexLines& lines, double t, const VertexLine*& line) {
  double lowest = kInfinity;
  line = lines.begin();  // kept where all heights are NaN
  for (const VertexLine& candidate : lines) {
    const double value = candidate.at(t);
    if (value < lowest) {
      lowest = value;
      line = &candidate;
    }
  }
  return lowest;
}

// Two balls with centres in straight relative motion: the first root of |d + u t|^2 = r^2.
double duration_of_balls(const Vector3d& d, const Vector3d& u, double gap, double radius) {
  const double approach = d.dot(u);
  if (approach >= 0) return kInfinity;
  const double excess = gap * (gap + 2 * radius);  // d.d - r^2 without cancellation
  const double discriminant = approach * approach - u.squaredNorm() * excess;
  return discriminant < 0 ? kInfinity : excess / (-approach + std::sqrt(discriminant));
}

// For how long nothing of the two comes by more than `way` nearer. [s]
double duration_of_way(const Relative& relative, double way) {
  return first_root_of_quadratic(way, -(relative.velocity.norm() + relative.turning_reach),
                                 -0.5 * (relative.acceleration.norm() + relative.deviation));
}

// Of the time that is asked for: shorter bounds are worth a second look.
constexpr double kShort = 1.0 / 16;

// Solids of so many pairs of pieces are looked ahead until they may have come by a part of the
// smaller one's radius nearer than they are; fewer are all tested within some ten milliseconds.
constexpr double kManyPairs = 1e5, kWay = 0.1;

}  // namespace

// Starts at the horizon and moves back to the first root of the lowest pair. Requires every pair's
// curve to be concave, so that a curve above zero at t was never below zero before.
double duration_of_lines(double gap, double rate, double half_acceleration, const VertexLines& a,
                         const VertexLines& b, double horizon) {
  if (a.size() == 1 && b.size() == 1) {
    return std::min(horizon, first_root_of_quadratic(gap, rate + a[0].rate + b[0].rate,
                                                     half_acceleration - a[0].half_acceleration -
                                                         b[0].half_acceleration));
  }
  half_acceleration = std::min(half_acceleration, 0.0);
  double t = horizon;
  while (t > 0) {
    const VertexLine *va, *vb;
    if (gap + lowest_at(a, t, va) + lowest_at(b, t, vb) + (rate + half_acceleration * t) * t > 0)
      return t;
    const double root =
        first_root_of_quadratic(gap + va->height + vb->height, rate + va->rate + vb->rate,
                                half_acceleration - va->half_acceleration - vb->half_acceleration);
    if (!(root < t)) return t;
    t = root;
  }
  return 0.0;
}

double first_root_of_quadratic(double g, double c, double q) {
  const double discriminant = c * c - 4 * q * g;
  if (discriminant < 0) return kInfinity;
  if (c < 0) return 2 * g / (-c + std::sqrt(discriminant));
  if (q >= 0) return kInfinity;
  return (c + std::sqrt(discriminant)) / (-2 * q);
}

TimeBound bound_time_apart(const CollisionShape& a, const MotionState& state_a,
                           const MotionBounds& bounds_a, const CollisionShape& b,
                           const MotionState& state_b, const MotionBounds& bounds_b, double horizon,
                           PairCache* cache, Effort effort) {
  if (a.is_half_space())
    return bound_time_apart(b, state_b, bounds_b, a, state_a, bounds_a, horizon, cache, effort);
  const double radius = a.radius() + b.radius();
  if (a.is_ball() && b.is_ball() && bounds_a.acceleration_world == bounds_b.acceleration_world &&
      bounds_a.acceleration_deviation + bounds_b.acceleration_deviation == 0.0) {
    const Vector3d between = state_a.pose.com_world - state_b.pose.com_world;
    const double gap = between.norm() - radius;
    const double duration = duration_of_balls(
        between, state_a.velocity_world - state_b.velocity_world, std::max(gap, 0.0), radius);
    return {std::min(horizon, duration), gap};
  }
  const Query query(a, state_a.pose, b, state_b.pose);
  Relative relative{state_a.velocity_world - state_b.velocity_world,
                    bounds_a.acceleration_world - bounds_b.acceleration_world,
                    bounds_a.acceleration_deviation + bounds_b.acceleration_deviation, 0.0};
  TimeBound bound{horizon, kInfinity};
  VertexLines lines_a, lines_b;
  const auto along = [&](double gap, const Vector3d& n, const VertexLines& of_b) {
    const double half_acceleration = 0.5 * (n.dot(relative.acceleration) - relative.deviation);
    const double duration = duration_of_lines(std::max(gap, 0.0), n.dot(relative.velocity),
                                              half_acceleration, lines_a, of_b, bound.duration);
    bound.duration = std::min(bound.duration, duration);
    bound.gap = std::min(bound.gap, gap);
  };

  if (b.is_half_space()) {
    const Vector3d n = query.rotation_b.col(2);
    if (a.ellipsoid()) {
      const Matrix3d body_from_world = query.rotation_a.transpose();
      const double arm = a.bounding_radius();
      bound.gap = gap_distance(a, state_a.pose, b, state_b.pose);
      bound.duration = duration_of_ellipsoid(
          *a.ellipsoid(), body_from_world * n, body_from_world * n.cross(state_a.omega_world),
          {std::max(bound.gap, 0.0),
           n.dot(relative.velocity) - bounds_a.angular_velocity_error * arm,
           0.5 * (n.dot(relative.acceleration) - relative.deviation -
                  acceleration_by_rotation(bounds_a) * arm)},
          horizon);
      return bound;
    }
    collect_lines({&a.corners(), query.rotation_a, query.offset}, state_a, bounds_a, n, 1.0,
                  lines_a);
    lines_b.push_back({0.0, 0.0, 0.0});  // a half-space does not rotate
    along(gap_distance(a, state_a.pose, b, state_b.pose), n, lines_b);
    return bound;
  }
  const double turning = 1.0 + 1e-12;  // the bounding radii are rounded
  relative.turning_reach =
      turning * ((a.bounding_radius() - a.radius()) *
                     (bounds_a.angular_speed + bounds_a.angular_velocity_error) +
                 (b.bounding_radius() - b.radius()) *
                     (bounds_b.angular_speed + bounds_b.angular_velocity_error));
  const auto shorten_by_pair = [&](int i, int j, const PolytopeGap& found) {
    collect_lines(query.piece_of_a(i), state_a, bounds_a, found.normal_b_to_a, 1.0, lines_a);
    collect_lines(query.piece_of_b(j), state_b, bounds_b, found.normal_b_to_a, -1.0, lines_b);
    const double before = bound.duration;
    along(found.distance - radius, found.normal_b_to_a, lines_b);
    const PlacedPolytope piece_a = query.piece_of_a(i), piece_b = query.piece_of_b(j);
    const MovingPiece of_a{piece_a, state_a, bounds_a}, of_b{piece_b, state_b, bounds_b};
    if (radius == 0.0 && bound.duration <= kShort * before)
      bound.duration = std::max(bound.duration, duration_of_edges({of_a, lines_a}, {of_b, lines_b},
                                                                  query, found, relative, before));
    if (effort == Effort::kUsual || bound.duration > kShort * before) return;
    const double gap = std::max(found.distance - radius, 0.0);
    bound.duration = std::max(
        {bound.duration, duration_in_frame(of_b, of_a, gap, found.normal_b_to_a, relative, before),
         duration_in_frame(of_a, of_b, gap, -found.normal_b_to_a, -relative, before)});
  };
  // The nearest pair first: the shorter its bound, the fewer other pairs can touch before.
  const NearestPieces nearest =
      nearest_pieces(query, relative.reach(horizon) + radius, cache, Points::kUnwanted);
  if (nearest.piece_a < 0) return bound;
  shorten_by_pair(nearest.piece_a, nearest.piece_b, nearest.gap);
  if (!a.is_closed_surface() && !b.is_closed_surface()) return bound;
  // Solids that pass or turn by each other may go far before the nearest pair touches: all pieces
  // may then meet all others, millions of pairs. Less is looked ahead.
  if (static_cast<double>(a.pieces().size()) * static_cast<double>(b.pieces().size()) >
      kManyPairs) {
    const double way = std::max(nearest.gap.distance - radius, 0.0) +
                       kWay * std::min(a.bounding_radius(), b.bounding_radius());
    bound.duration = std::min(bound.duration, duration_of_way(relative, way));
  }
  for (const auto& [i, j] : pieces_within(query, relative.reach(bound.duration) + radius, cache)) {
    if (i == nearest.piece_a && j == nearest.piece_b) continue;
    const double limit = relative.reach(bound.duration) + radius;
    const PolytopeGap found =
        surface_gap(query.piece_of_a(i), query.piece_of_b(j), query.size, limit, Points::kUnwanted);
    if (!found.beyond && found.distance <= limit) shorten_by_pair(i, j, found);
  }
  return bound;
}

}  // namespace tumble::collision
