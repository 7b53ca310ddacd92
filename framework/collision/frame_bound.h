/// How long two convex pieces stay apart, seen from one of them.
///
/// Along a fixed normal a face that turns dips at its far corners, and a search beside a ball or a
/// corner that hovers over it takes thousands of steps of (E.1). Along the normal that turns with
/// it, the face stays where it is, and only what the other solid's vertices do counts. In the frame
/// of B, with d the arm from B's centre to a vertex of A, r that from A's own, u the relative
/// velocity of the centres, W = w + e the rate at which a path turns:
///   f  = u + w_A x r - w_B x d,   the vertex's velocity, but for |e_A| |r| + |e_B| |d|
///   |f'| <= |a| + (|alpha_A| + |w_A| |W_A|) |r| + |alpha_B| |d| + |w_B| (|u| + |W_A| |r|)
///           + |W_B| (|u| + |w_A| |r| + |w_B| |d|)
///   n . d(tau) >= n . d(0) + (n . f - |e_A| |r| - |e_B| |d|) tau - |f'| tau^2 / 2       (E.3)
/// where |w|, |alpha|, |u| and |d| bound the whole time. The step grows as the root of the gap.
#pragma once

#include "framework/collision/vertex_lines.h"

namespace tumble::collision {

/// @param gap        of the two pieces, >= 0 [m]
/// @param normal     of that gap, unit, from `frame` to `other`
/// @param relative   motion of the centre of `other` against that of `frame`
/// @param horizon    how far ahead to look [s]
/// @return a lower bound on the time until contact [s], at most the horizon
double duration_in_frame(const MovingPiece& frame, const MovingPiece& other, double gap,
                         const Vector3d& normal, const Relative& relative, double horizon);

}  // namespace tumble::collision
