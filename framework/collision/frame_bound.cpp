#include "framework/collision/frame_bound.h"

namespace tumble::collision {

double duration_in_frame(const MovingPiece& frame, const MovingPiece& other, double gap,
                         const Vector3d& normal, const Relative& relative, double horizon) {
  const Polytope& p = *other.piece.polytope;
  const Vector3d offset = other.piece.translation - frame.piece.translation;
  const Vector3d &w_other = other.state.omega_world, &w_frame = frame.state.omega_world;
  const double acceleration = relative.acceleration.norm() + relative.deviation,
               most_speed = relative.velocity.norm() + acceleration * horizon,
               turn = frame.bounds.angular_speed, turn_other = other.bounds.angular_speed,
               path_turn = turn + frame.bounds.angular_velocity_error,
               path_turn_other = turn_other + other.bounds.angular_velocity_error;
  double lowest;
  p.lowest(other.piece.in_body(normal), lowest);
  const double base = normal.dot(offset);
  VertexLines lines;
  for (int i = 0; i < other.piece.size(); ++i) {
    const Vector3d r = other.piece.query_from_body * p.vertices[static_cast<std::size_t>(i)],
                   d = offset + r;
    const double arm = p.arms[static_cast<std::size_t>(i)],
                 most_away = d.norm() + most_speed * horizon;
    const Vector3d f = relative.velocity + w_other.cross(r) - w_frame.cross(d);
    const double most_change =
        acceleration + (other.bounds.angular_acceleration + turn_other * path_turn_other) * arm +
        frame.bounds.angular_acceleration * most_away +
        turn * (most_speed + path_turn_other * arm) +
        path_turn * (most_speed + turn_other * arm + turn * most_away);
    lines.push_back({normal.dot(d) - base - lowest,
                     normal.dot(f) - other.bounds.angular_velocity_error * arm -
                         frame.bounds.angular_velocity_error * most_away,
                     0.5 * most_change});
  }
  VertexLines still;  // of the frame itself
  still.push_back({0.0, 0.0, 0.0});
  return duration_of_lines(gap, 0.0, 0.0, lines, still, horizon);
}

}  // namespace tumble::collision
