/// A lower bound on the time of impact: how long two moving solids certainly stay apart.
///
/// For a pair of convex pieces at the distance `gap` along the unit normal n (from B to A), every
/// vertex a of A stays above every vertex b of B along the fixed direction n while
///   gap + h_a + h_b + (n.u + n.(w_A x r_a) - n.(w_B x r_b)) tau + (n.a_rel - A_a
///       - A_b) tau^2 / 2 > 0                                                                 (E.1)
/// where h are the heights of the vertices over the supporting planes, u and a_rel the relative
/// velocity and acceleration of the centres, r the arms from them, and A = (|alpha| + |w| (|w| +
/// e)) |r| the largest acceleration of a vertex by rotation. A numerical path rotates at w + e,
/// where w is the angular velocity in its states: the rate of an arm is w x r + e x r. The second
/// term is bounded by |e| |r|; the first changes at the rate alpha x r + w x ((w + e) x r). For
/// solids that are not convex, every pair of pieces that can come near within the bound is tested.
/// Two edges that turn while they are near have a longer bound along a normal that turns with them,
/// (E.2) of edge_bound.h; in the frame of one of the two, (E.3) of frame_bound.h.
/// For an ellipsoid over a half-space, the support function covers all points of the surface at
/// once (ellipsoid.h).
/// Source: B. Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems, PhD thesis, Berkeley
/// 1996, ch. 2, extended to arms of single vertices.
#pragma once

#include "framework/collision/gap.h"
#include "framework/collision/motion.h"

namespace tumble::collision {

struct TimeBound {
  // [s], in [0, horizon]: no contact before; exactly the horizon where none is possible before it
  double duration;
  // [m]: of the nearest pieces; infinite where all are too far apart to touch before the horizon
  double gap;
};

/// kMore: by (E.3) too, which costs as much again and pays where a search takes many steps.
enum class Effort { kUsual, kMore };

/// @param horizon  [s], >= 0: how far ahead to look; the motion bounds must hold that long
/// @param cache    of this pair, may be null
TimeBound bound_time_apart(const CollisionShape& a, const MotionState& state_a,
                           const MotionBounds& bounds_a, const CollisionShape& b,
                           const MotionState& state_b, const MotionBounds& bounds_b, double horizon,
                           PairCache* cache = nullptr, Effort effort = Effort::kUsual);

/// First t >= 0 at which g + c t + q t^2 falls below zero, given g >= 0; infinite where it never
/// does.
double first_root_of_quadratic(double g, double c, double q);

}  // namespace tumble::collision
