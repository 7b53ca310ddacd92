/// The contact normal of two solids of several pieces that touch. Internal to collision.
///
/// The pieces beside the place of contact touch too, mostly with an edge or a corner, and such a
/// pair alone allows many normals, most of which lead one solid into the other. A contact normal of
/// the solids separates every pair that touches there:
///   n . (a - b) >= 0   for all points a, b of each pair
/// Of the normals of the faces that touch, and else of those of the pairs, those that separate most
/// pairs are taken: all, where the solids touch at one place. Of several, as where a corner meets a
/// corner, their middle, if it separates as many: it does not depend on the last digit, and it
/// respects mirror symmetry.
#pragma once

#include "framework/collision/piece_pairs.h"

namespace tumble::collision {

/// @param nearest  of the solids, with points
/// @param cache    of this pair, may be null
/// @return `nearest.gap` with the normal of the contact and points of a pair that has it; unchanged
///   where the solids do not touch, and where all pairs that touch have the same normal
PolytopeGap with_common_normal(const Query& query, const NearestPieces& nearest, PairCache* cache);

}  // namespace tumble::collision
