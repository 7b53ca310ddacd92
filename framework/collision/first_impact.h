/// The first contact of two moving solids, never missed however fast or thin they are.
#pragma once

#include <cstdint>
#include <optional>

#include "framework/collision/gap.h"
#include "framework/collision/motion.h"
#include "framework/core/root.h"

namespace tumble::collision {

/// Narrows a bracket in which the gap closes; as Laws::find_impact_time.
using RootFinder =
    std::function<RootResult(const ScalarFunction& gap, const ScalarFunction& gap_rate, double t_low, double t_high, double tolerance)>;

struct ImpactOptions {
  RootFinder root_finder;               // empty: bisection
  PairCache* cache = nullptr;           // of this pair, kept by the caller; see pair_cache.h
};

/// What the search cost.
struct ImpactCost {
  std::uint64_t gap_evaluations = 0;
  std::uint64_t root_findings = 0;
};

/// The last instant at which the two are still apart or just touch.
struct Impact {
  double time;      // [s]
  Gap gap;          // at `time`; distance >= 0, and negative one representable instant later
  double rate;      // [m/s], of the gap: n . (velocity of A's witness point - of B's); negative when approaching
};

/// Conservative advancement on the bounds of time_bound.h up to a bracket, then `options.root_finder`, then to adjacent doubles:
/// there is no shell around the bodies that would bias the time. A root finder that answers nonsense costs time, never correctness.
/// @param t0, t1  [s], t0 <= t1; the motions' bounds must hold in between
/// @pre the two do not overlap at t0 (if they do, the impact is at t0 with the negative gap)
/// @return nothing where they stay apart until t1. A graze shallower than round-off may be reported either way. Solids that slide along
///         each other so that 2000 advances do not get to t1 are looked at in longer strides: there a graze shallower than 1e-8 of the
///         smaller one's size may pass, and a corner that is clipped within a stride; an overlap that lasts never does
std::optional<Impact> first_impact(const CollisionShape& a, const Motion& motion_a, const CollisionShape& b, const Motion& motion_b,
                                   double t0, double t1, const ImpactOptions& options = {}, ImpactCost* cost = nullptr);

/// Velocity at which a gap changes. [m/s]
double gap_rate(const Gap& gap, const MotionState& a, const MotionState& b);

}  // namespace tumble::collision
