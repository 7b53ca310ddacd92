/// Vertices of a moving solid over a plane, as bounds on when they come down to it: the parts of
/// (E.1) and (E.2).
#pragma once

#include "framework/collision/inline_vector.h"
#include "framework/collision/motion.h"
#include "framework/collision/piece_pairs.h"

namespace tumble::collision {

/// One vertex: height over the supporting plane, rate along the normal, and half the bound on its
/// acceleration.
struct VertexLine {
  double height, rate, half_acceleration;
  double at(double t) const { return height + (rate - half_acceleration * t) * t; }
};

using VertexLines = InlineVector<VertexLine, 32>;

/// A piece, and how its solid moves.
struct MovingPiece {
  const PlacedPolytope& piece;
  const MotionState& state;
  const MotionBounds& bounds;
};

/// How the centres of two solids move against each other, A against B.
struct Relative {
  Vector3d velocity, acceleration;
  double deviation, turning_reach;  // [m/s^2], [m/s]

  /// B against A.
  Relative operator-() const { return {-velocity, -acceleration, deviation, turning_reach}; }
  double reach(double t) const {
    return ((velocity.norm() + turning_reach) + 0.5 * (acceleration.norm() + deviation) * t) * t;
  }
};

/// Largest acceleration by rotation, per length of the arm. [1/s^2]
inline double acceleration_by_rotation(const MotionBounds& bounds) {
  return bounds.angular_acceleration +
         bounds.angular_speed * (bounds.angular_speed + bounds.angular_velocity_error);
}

/// Largest t up to `horizon` for which, on [0, t], every vertex of A stays above every one of B:
///   gap + a(t) + b(t) + rate t + half_acceleration t^2 > 0
double duration_of_lines(double gap, double rate, double half_acceleration, const VertexLines& a,
                         const VertexLines& b, double horizon);

}  // namespace tumble::collision
