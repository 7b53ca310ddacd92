/// How long two edges that are nearest to each other stay apart, and with them their solids.
///
/// Along a fixed normal an edge that turns dips at one of its ends, however far from the other edge
/// that end is: (E.1) ends after about the gap over the speed of the end, and a search along two
/// edges that graze takes thousands of such steps. Along the normal of both edges, which turns with
/// them,
///   n = p x q / |p x q|_0,   p, q the directions of the edges of A and of B,
/// each edge stays at height 0 over itself. With D from the nearest point of B's line to that of
/// A's (material points: they turn with the bodies), r arms from these, V >= |D'| and A >= |D''|,
///   n . D       >= gap + (n'.D + n.D') tau - (|n''| |D| + 2 |n'| V + |n| A) tau^2 / 2
///   n . r of A  >= n.r + (n' + n x w_A).r tau - (|n''| + 2 |n'| |w_A| + |n| A_A) |r| tau^2 / 2
/// and the solids stay apart while the first and the least of each solid's sum to more than 0.
///   |n'| <= (|w_A| + |w_B|) / s,   |n''| <= ((|w_A| + |w_B|)^2 + |alpha_A| + |alpha_B|) / s,
///   |n| <= 1 / s,   s = |p x q|_0                                                          (E.2)
/// where |w|, |alpha| bound the whole time, and A_A is of (E.1). A numerical path, which turns at
/// w + e, has |w| + |e| for |w|, and its rates are lower by up to (|e_A| + |e_B|) |D| / s, and by
/// |n| |e| times the arm. The step grows as the root of the gap, no longer as the gap.
#pragma once

#include "framework/collision/piece_pairs.h"
#include "framework/collision/vertex_lines.h"

namespace tumble::collision {

struct EdgeSide : MovingPiece {
  const VertexLines& lines;  ///< along `found`: what lies at height 0 is nearest
};

/// @param found    of these pieces, apart; solids without rounding radius
/// @param horizon  how far ahead to look [s]
/// @return a lower bound on the time until contact [s], at most the horizon; 0 where the nearest
///   are not two edges that cross
double duration_of_edges(const EdgeSide& a, const EdgeSide& b, const Query& query,
                         const PolytopeGap& found, const Relative& relative, double horizon);

}  // namespace tumble::collision
