#include "framework/collision/edge_bound.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace tumble::collision {
namespace {

// Heights that are 0 but for rounding, in parts of the query's size: the normal's is 1e-15 of it.
constexpr double kOnPlane = 1e-10;
// Of the angle between the edges: below, the bounds on n' and n'' are loose.
constexpr double kLeastSine = 0.1;
// rad, of both solids: farther ahead, the bounds on |D| and |D'| are loose.
constexpr double kMostTurn = 0.1;

Vector3d arm(const EdgeSide& side, int vertex) {
  return side.piece.query_from_body *
         side.piece.polytope->vertices[static_cast<std::size_t>(vertex)];
}

/// The two vertices that alone lie on the supporting plane; nothing where there are fewer or more.
std::optional<std::pair<int, int>> ends_of_edge(const VertexLines& lines, double rounding) {
  std::optional<int> first, second;
  for (int i = 0; i < static_cast<int>(lines.size()); ++i) {
    if (lines.begin()[i].height > rounding) continue;
    if (second) return std::nullopt;
    (first ? second : first) = i;
  }
  if (!second) return std::nullopt;
  return std::pair{*first, *second};
}

struct TurningNormal {
  Vector3d n, rate;
  double speed, acceleration, length;  // bounds on |n'|, |n''|, |n|
  double error;                        // of the rate, on a numerical path, at most
};

// How fast the path turns, at most. [rad/s]
double path_turn(const MotionBounds& bounds) {
  return bounds.angular_speed + bounds.angular_velocity_error;
}

/// Heights over the edge along n, or along -n. @param on_edge  an arm to the edge's line
void collect_lines(const TurningNormal& normal, const EdgeSide& side, std::pair<int, int> ends,
                   const Vector3d& on_edge, double sign, VertexLines& lines) {
  lines.clear();
  const Vector3d turn = normal.rate + normal.n.cross(side.state.omega_world);
  const double half_acceleration =
      0.5 * (normal.acceleration + 2.0 * normal.speed * path_turn(side.bounds) +
             normal.length * acceleration_by_rotation(side.bounds));
  const double error = normal.error + normal.length * side.bounds.angular_velocity_error;
  for (int i = 0; i < side.piece.size(); ++i) {
    const Vector3d r = arm(side, i) - on_edge;
    if (i == ends.first || i == ends.second)
      lines.push_back({0.0, 0.0, 0.0});
    else
      lines.push_back({sign * normal.n.dot(r), sign * turn.dot(r) - error * r.norm(),
                       half_acceleration * r.norm()});
  }
}

}  // namespace

double duration_of_edges(const EdgeSide& a, const EdgeSide& b, const Query& query,
                         const PolytopeGap& found, const Relative& relative, double horizon) {
  const double rounding = kOnPlane * query.size;
  const auto ends_a = ends_of_edge(a.lines, rounding), ends_b = ends_of_edge(b.lines, rounding);
  if (!ends_a || !ends_b) return 0.0;
  const Vector3d p = (arm(a, ends_a->second) - arm(a, ends_a->first)).normalized(),
                 q = (arm(b, ends_b->second) - arm(b, ends_b->first)).normalized();
  const Vector3d product = p.cross(q);
  const double sine = product.norm();
  if (!(sine > kLeastSine)) return 0.0;

  // n and what bounds it.
  const Vector3d &w_a = a.state.omega_world, &w_b = b.state.omega_world;
  const double scale = (product.dot(found.normal_b_to_a) < 0.0 ? -1.0 : 1.0) / sine,
               speed = path_turn(a.bounds) + path_turn(b.bounds),
               until = std::min(horizon, kMostTurn / speed);
  TurningNormal normal{
      scale * product,
      scale * (w_a.cross(p).cross(q) + p.cross(w_b.cross(q))),
      speed / sine,
      (speed * speed + a.bounds.angular_acceleration + b.bounds.angular_acceleration) / sine,
      1.0,
      (a.bounds.angular_velocity_error + b.bounds.angular_velocity_error) / sine};
  normal.length = std::min(1.0 / sine, 1.0 + normal.speed * until);

  // The nearest points of the two lines, and how they part.
  Vector3d x = arm(a, ends_a->first), y = arm(b, ends_b->first);
  const Vector3d between = query.offset + x - y;
  const double cosine = p.dot(q), along_p = p.dot(between), along_q = q.dot(between);
  x += (cosine * along_q - along_p) / (sine * sine) * p;
  y += (along_q - cosine * along_p) / (sine * sine) * q;
  const Vector3d apart = query.offset + x - y,
                 parting = relative.velocity + w_a.cross(x) - w_b.cross(y);
  if (!(std::abs(normal.n.dot(apart) - found.distance) <= rounding)) return 0.0;
  const double acceleration = relative.acceleration.norm() + relative.deviation +
                              acceleration_by_rotation(a.bounds) * x.norm() +
                              acceleration_by_rotation(b.bounds) * y.norm(),
               error = a.bounds.angular_velocity_error * x.norm() +
                       b.bounds.angular_velocity_error * y.norm(),
               most_parting = parting.norm() + error + acceleration * until,
               most_apart = apart.norm() + most_parting * until;

  VertexLines lines_a, lines_b;
  collect_lines(normal, a, *ends_a, x, 1.0, lines_a);
  collect_lines(normal, b, *ends_b, y, -1.0, lines_b);
  return duration_of_lines(
      std::max(found.distance, 0.0),
      normal.rate.dot(apart) + normal.n.dot(parting) - normal.error * most_apart -
          normal.length * error,
      -0.5 * (normal.acceleration * most_apart + 2.0 * normal.speed * most_parting +
              normal.length * acceleration),
      lines_a, lines_b, until);
}

}  // namespace tumble::collision
