/// Continuous collision detection: the first contact of two moving solids, without tunnelling,
/// however fast or thin they are.
#pragma once

#include <cstdint>
#include <optional>

#include "framework/collision/gap.h"
#include "framework/collision/motion.h"
#include "framework/core/root.h"

namespace tumble::collision {

/// Narrows a bracket in which the gap closes, like Laws::find_impact_time.
using RootFinder =
    std::function<RootResult(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                             double t_low, double t_high, double tolerance)>;

struct ImpactOptions {
  RootFinder root_finder;      // empty: bisection
  PairCache* cache = nullptr;  // of this pair, owned by the caller; see pair_cache.h
};

/// Cost of the search.
struct ImpactCost {
  std::uint64_t gap_evaluations = 0;
  std::uint64_t root_findings = 0;
};

/// The last instant at which the solids are still apart or just touch.
struct Impact {
  double time;  // [s]
  Gap gap;      // at `time`; distance >= 0, and negative at the next representable time
  // [m/s], of the gap: n . (velocity of A's witness point - B's); negative when approaching
  double rate;
};

/// Conservative advancement by the bounds of time_bound.h to a bracket, then `options.root_finder`,
/// then bisection to adjacent doubles. No margin around the bodies biases the time. A wrong result
/// of the root finder costs time, never correctness.
/// @param t0, t1  [s], t0 <= t1; the motions' bounds must hold in between
/// @pre the solids do not overlap at t0 (if they do, the impact is at t0 with the negative gap,
///   unless that is a rounding and opens)
/// @return nothing where they stay apart until t1. A grazing contact shallower than round-off may
///   be reported or not. Where solids slide along each other and 2000 advances do not reach t1, the
///   advances grow: then a grazing contact shallower than 1e-8 of the smaller solid's size may be
///   missed, and a corner clipped within one advance; a lasting overlap is never missed
std::optional<Impact> first_impact(const CollisionShape& a, const Motion& motion_a,
                                   const CollisionShape& b, const Motion& motion_b, double t0,
                                   double t1, const ImpactOptions& options = {},
                                   ImpactCost* cost = nullptr);

/// Rate of change of a gap. [m/s]
double gap_rate(const Gap& gap, const MotionState& a, const MotionState& b);

}  // namespace tumble::collision
