#include "framework/collision/first_impact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/collision/time_bound.h"
#include "framework/core/numbers.h"

namespace tumble::collision {
namespace {

// Least advance, as a fraction of the interval: without it, two solids that slide along each other
// would never reach the end. A contact within one least advance is missed only where one solid
// clips a corner of the other over a chord shorter than their speed times the advance: 5e-8 m at
// 300 m/s and a step of 1/60 s. An overlap at either end of an advance is always detected.
constexpr double kLeastAdvance = 1e-8;
// After this many advances the least advance grows by the factor kGrowth each time, and with it the
// chord that may be missed. A curved path may also penetrate between two tests, by at most A s^2 /
// 8, where A bounds the relative acceleration and s is the advance: it is limited to kShallow of
// the smaller solid's size.
constexpr int kPlainAdvances = 2000;
// After this many each is worth a closer look at how long it may be.
constexpr int kFewAdvances = 256;
constexpr double kGrowth = 1.02;
constexpr double kShallow = 1e-8;

struct Search {
  const CollisionShape& a;
  const CollisionShape& b;
  const Motion& motion_a;
  const Motion& motion_b;
  const ImpactOptions& options;
  ImpactCost& cost;
  PairCache* cache;

  double gap_at(double t) const {
    ++cost.gap_evaluations;
    return gap_distance(a, motion_a.at(t).pose, b, motion_b.at(t).pose, cache);
  }
  double rate_at(double t) const {
    const MotionState sa = motion_a.at(t), sb = motion_b.at(t);
    ++cost.gap_evaluations;
    return gap_rate(compute_gap(a, sa.pose, b, sb.pose, cache), sa, sb);
  }
  Impact impact_at(double t) const {
    const MotionState sa = motion_a.at(t), sb = motion_b.at(t);
    const Gap gap = compute_gap(a, sa.pose, b, sb.pose, cache);
    return {t, gap, gap_rate(gap, sa, sb)};
  }
};

double next_after(double t) { return std::nextafter(t, std::numeric_limits<double>::infinity()); }

// Shrinks [low, high] (gap >= 0 at low, < 0 at high) to adjacent doubles: by growing strides from
// low, which is near the root, then by bisection.
double last_instant_apart(const Search& search, double low, double high) {
  double stride = next_after(high) - high;
  while (low + stride < high) {
    const double probe = low + stride;
    if (search.gap_at(probe) < 0) {
      high = probe;
      break;
    }
    low = probe;
    stride *= 4;
  }
  for (;;) {
    const double middle = low + 0.5 * (high - low);
    if (!(middle > low && middle < high) || high - low <= 0.5 * (next_after(high) - high))
      return low;
    (search.gap_at(middle) < 0 ? high : low) = middle;
  }
}

// gap(low) >= 0 > gap(high)
Impact refine(const Search& search, double low, double high) {
  if (search.options.root_finder) {
    ++search.cost.root_findings;
    const double tolerance = 4 * (next_after(high) - high);
    const RootResult root = search.options.root_finder([&](double t) { return search.gap_at(t); },
                                                       [&](double t) { return search.rate_at(t); },
                                                       low, high, tolerance);
    // Only the sign of the gap at the result is used: a wrong result leaves the bracket unchanged.
    if (root.time > low && root.time < high) {
      const double behind = root.time - 2 * (next_after(root.time) - root.time);
      if (search.gap_at(root.time) >= 0) {
        low = root.time;
      } else {
        high = root.time;
        if (behind > low && search.gap_at(behind) >= 0) low = behind;
      }
    }
  }
  return search.impact_at(last_instant_apart(search, low, high));
}

// The bound excludes a contact between t_apart and t_overlap up to rounding, so the root lies just
// before t_overlap. The start of the bracket moves close to it, away from a previous contact, where
// rounding makes the sign of the gap flicker.
double shorten(const Search& search, double t_apart, double t_overlap) {
  for (const double part : {1e-6, 1e-3, 0.5}) {
    const double t = t_overlap - part * (t_overlap - t_apart);
    if (t > t_apart && t < t_overlap && search.gap_at(t) >= 0) return t;
  }
  return t_apart;
}

double smaller_size(const Search& search) {
  return std::min(search.a.bounding_radius(), search.b.bounding_radius());
}

// Bound on the relative acceleration of any point of A and any point of B. [m/s^2]
double largest_acceleration(const Search& search) {
  const auto own = [](const CollisionShape& shape, const MotionBounds& m) {
    const double arm = shape.is_half_space() ? 0.0 : shape.bounding_radius() - shape.radius();
    return m.acceleration_deviation +
           arm * (m.angular_acceleration +
                  m.angular_speed * (m.angular_speed + m.angular_velocity_error));
  };
  const MotionBounds &a = search.motion_a.bounds, &b = search.motion_b.bounds;
  return (a.acceleration_world - b.acceleration_world).norm() + own(search.a, a) + own(search.b, b);
}

// Relative to the scale of a gap: what it may be off by.
constexpr double kRounding = 64 * kEpsilon;

// Where a gap < 0 at t is what rounding makes of one that opens from t0 on, where it was closed:
// the time at which it has opened by more than that. Without it two solids that part slowly would
// meet again at once, and time would stand still.
std::optional<double> seen_open(const Search& search, double gap, double t0, double t) {
  const MotionState sa = search.motion_a.at(t0), sb = search.motion_b.at(t0);
  const double rounding = kRounding * gap_scale(search.a, sa.pose, search.b, sb.pose);
  if (gap < -rounding) return std::nullopt;
  const Gap at_start = compute_gap(search.a, sa.pose, search.b, sb.pose, search.cache);
  const double rate = gap_rate(at_start, sa, sb);
  if (!(rate > 0) || !(at_start.distance <= rounding)) return std::nullopt;
  const double wait = 2 * rounding / rate;
  // a path that bends may close it again
  if (t >= t0 + wait || largest_acceleration(search) * wait > rate) return std::nullopt;
  return t0 + wait;
}

// A feature smaller than this fraction of the solid may be missed.
constexpr double kSmallestFeature = 1e-9;

// Whether, within `duration`, only the nearest parts of the solids can touch and separate again.
// True for two convex solids in almost straight relative motion: a line intersects their Minkowski
// difference in one interval. For solids of several pieces, true only while they move past each
// other by less than a feature.
bool one_entry(const Search& search, const MotionState& sa, const MotionState& sb,
               double duration) {
  const auto convex = [](const CollisionShape& shape) { return shape.pieces().size() <= 1; };
  if (convex(search.a) && convex(search.b)) return true;
  const auto turning = [](const CollisionShape& shape, const MotionBounds& m) {
    return shape.is_half_space() ? 0.0 : m.angular_speed * shape.bounding_radius();
  };
  const double speed = (sa.velocity_world - sb.velocity_world).norm() +
                       turning(search.a, search.motion_a.bounds) +
                       turning(search.b, search.motion_b.bounds);
  return speed * duration <= kSmallestFeature * smaller_size(search);
}

// A time just after the root, where the gap closes almost linearly; nothing where the path is too
// curved.
std::optional<double> behind_the_root(const Search& search, double t, double t1) {
  const MotionState sa = search.motion_a.at(t), sb = search.motion_b.at(t);
  const Gap gap = compute_gap(search.a, sa.pose, search.b, sb.pose, search.cache);
  const double rate = gap_rate(gap, sa, sb);
  if (!(rate < 0) || gap.distance < 0) return std::nullopt;
  const double wait = gap.distance / -rate;
  if (largest_acceleration(search) * wait > 0.1 * -rate) return std::nullopt;
  const double behind = t + std::max(1.5 * wait, 8 * (next_after(t) - t));
  if (behind > t1 || !one_entry(search, sa, sb, behind - t)) return std::nullopt;
  return behind;
}

}  // namespace

double gap_rate(const Gap& gap, const MotionState& a, const MotionState& b) {
  const Vector3d velocity_a =
      a.velocity_world + a.omega_world.cross(gap.point_a_world - a.pose.com_world);
  const Vector3d velocity_b =
      b.velocity_world + b.omega_world.cross(gap.point_b_world - b.pose.com_world);
  return gap.normal_b_to_a_world.dot(velocity_a - velocity_b);
}

std::optional<Impact> first_impact(const CollisionShape& a, const Motion& motion_a,
                                   const CollisionShape& b, const Motion& motion_b, double t0,
                                   double t1, const ImpactOptions& options, ImpactCost* cost) {
  ImpactCost unasked;
  PairCache own;
  const Search search{a,
                      b,
                      motion_a,
                      motion_b,
                      options,
                      cost ? *cost : unasked,
                      options.cache ? options.cache : &own};
  double least = kLeastAdvance * (t1 - t0);
  // infinite for straight paths
  const double most_least =
      std::sqrt(8.0 * kShallow * smaller_size(search) / largest_acceleration(search));
  double t = t0, t_apart = t0;
  for (int round = 0;; ++round) {
    ++search.cost.gap_evaluations;
    const TimeBound bound = bound_time_apart(a, motion_a.at(t), motion_a.bounds, b, motion_b.at(t),
                                             motion_b.bounds, t1 - t, search.cache,
                                             round < kFewAdvances ? Effort::kUsual : Effort::kMore);
    double next;
    if (bound.gap < 0) {
      const auto later = seen_open(search, bound.gap, t0, t);
      if (!later)
        return t > t0 ? refine(search, shorten(search, t_apart, t), t) : search.impact_at(t);
      next = *later;
    } else {
      if (bound.duration >= t1 - t) return std::nullopt;
      t_apart = t;
      if (round > 0 && bound.gap < kInfinity) {
        if (const auto behind = behind_the_root(search, t, t1);
            behind && search.gap_at(*behind) < 0)
          return refine(search, t, *behind);
      }
      if (round > kPlainAdvances) least = std::max(least, std::min(kGrowth * least, most_least));
      next = std::max(t + std::max(bound.duration, least), next_after(t));
    }
    t = std::min(t1, next);
    if (t >= t1) {
      const double gap = search.gap_at(t1);
      if (gap < 0 && !seen_open(search, gap, t0, t1))
        return refine(search, shorten(search, t_apart, t1), t1);
      return std::nullopt;
    }
  }
}

}  // namespace tumble::collision
