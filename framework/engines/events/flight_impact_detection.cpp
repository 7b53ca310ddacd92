#include "framework/engines/events/flight_impact_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/collision/time_bound.h"
#include "framework/core/numbers.h"
#include "framework/core/text.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

// Rounding may put a root in closed form after the impact: it is moved back until the gap is not
// negative, first by one spacing of the time, then by twice as much in each iteration.
template <class Gap>
double last_instant_apart(double begin, double time, const Gap& gap) {
  double stride = std::nextafter(time, kInfinity) - time;
  while (time > begin && gap(time) < 0) {
    time = std::max(begin, time - stride);
    stride *= 2;
  }
  return time;
}

}  // namespace

EventStamp key_of_impact(int a, const Flight& f, int b, const Flight& g, double time) {
  std::uint32_t microstep = 0;
  if (time == f.begin) microstep = f.microstep + 1;
  if (time == g.begin) microstep = std::max(microstep, g.microstep + 1);
  return {time, microstep, StampKind::kCollision, std::min(a, b), std::max(a, b)};
}

std::int64_t FlightImpactDetection::window_of(double t) const {
  // the division rounds; windows begin at k * window_
  std::int64_t k = static_cast<std::int64_t>(std::floor(t / window_));
  while (window_begin(k + 1) <= t) ++k;
  while (window_begin(k) > t) --k;
  return k;
}

bool FlightImpactDetection::has_closed_form(int a, const Flight& f, int b, const Flight& g) const {
  if (f.segment >= 0 || g.segment >= 0) return false;
  if (world_.is_half_space(a) || world_.is_half_space(b)) {
    const int plane = world_.is_half_space(a) ? a : b, other = world_.is_half_space(a) ? b : a;
    return world_.is_ball(other) && world_.is_still(plane);
  }
  if (!world_.is_ball(a) || !world_.is_ball(b)) return false;
  if (!(world_.can_move(a) || world_.is_still(a)) || !(world_.can_move(b) || world_.is_still(b)))
    return false;
  return falls(a, f) == falls(b, g) || world_.gravity_world().isZero(0.0);
}

double FlightImpactDetection::first_impact(int a, const Flight& f, int b, const Flight& g,
                                           double from, double to, CheckCost& cost) const {
  // A resting ball never collides with its support, nor with anything else that stands; a driven
  // body does not.
  const auto stands = [&](int body, const Flight& flight) {
    return flight.is_resting || world_.is_still(body);
  };
  if (stands(a, f) && stands(b, g)) return kInfinity;
  if (world_.is_internal(a, f, b, g)) return kInfinity;
  if (!has_closed_form(a, f, b, g)) return in_windows(a, f, b, g, from, to, cost);
  ++cost.pair_checks;
  if (world_.is_half_space(a)) return of_ball_and_plane(b, g, f);
  if (world_.is_half_space(b)) return of_ball_and_plane(a, f, g);
  return of_balls(a, f, b, g);
}

// |d + u tau|^2 = R^2 with d.d - R^2 = c:   tau = c / (-d.u + sqrt((d.u)^2 - u.u c)), the first
// root, without cancellation.
double FlightImpactDetection::of_balls(int a, const Flight& f, int b, const Flight& g) const {
  const double begin = std::max(f.begin, g.begin), reach = world_.radius(a) + world_.radius(b);
  const Vector3d d = world_.position(a, f, begin) - world_.position(b, g, begin);
  const Vector3d u = world_.velocity(a, f, begin) - world_.velocity(b, g, begin);
  const double approach = d.dot(u);
  if (!(approach < 0)) return kInfinity;
  const double excess = d.squaredNorm() - reach * reach;
  if (excess <= 0) return begin;
  const double discriminant = approach * approach - u.squaredNorm() * excess;
  if (!(discriminant >= 0)) return kInfinity;
  const double time = begin + excess / (-approach + std::sqrt(discriminant));
  if (!(time < kInfinity)) return kInfinity;
  return last_instant_apart(begin, time, [&](double t) {
    return (world_.position(a, f, t) - world_.position(b, g, t)).norm() - reach;
  });
}

// h + c tau + q tau^2 = 0 with the height h over the plane, its rate c, and half the gravity along
// the normal q.
double FlightImpactDetection::of_ball_and_plane(int ball, const Flight& f,
                                                const Flight& plane) const {
  if (f.is_resting) return kInfinity;
  const Vector3d normal = plane.world_from_body * Vector3d::UnitZ();
  const auto height = [&](double t) {
    return normal.dot(world_.position(ball, f, t) - plane.com_world) - world_.radius(ball);
  };
  const double h = height(f.begin), c = normal.dot(f.velocity_world),
               q = 0.5 * normal.dot(world_.gravity_world());
  if (h <= 0 && c < 0) return f.begin;
  if (h <= 0 && c == 0 && q < 0) return f.begin;
  double after;
  if (q == 0) after = c < 0 ? h / -c : kInfinity;
  // it separates from the plane right now
  else if (h <= 0)
    after = q < 0 && c > 0 ? c / -q : kInfinity;
  else
    after = collision::first_root_of_quadratic(h, c, q);
  if (!(f.begin + after < kInfinity)) return kInfinity;
  return last_instant_apart(f.begin, f.begin + after, height);
}

// A relative path whose acceleration is at most a deviates from its chord by at most a s^2 / 8; a
// body that is shaken, by at most twice the amplitude.
bool FlightImpactDetection::may_meet(int a, const Flight& f, int b, const Flight& g, double low,
                                     double high) const {
  const auto driven = [&](int body) { return !world_.can_move(body) && !world_.is_still(body); };
  if (f.segment >= 0 || g.segment >= 0)
    return driven(a) || driven(b) || may_meet_on_segment(a, f, b, g, low, high);
  const double s = high - low;
  const auto shake = [&](int body) {
    if (!driven(body)) return 0.0;
    const scene::PrescribedMotion& m = world_.world().bodies[static_cast<std::size_t>(body)].motion;
    const double turn = m.angular_frequency_rad_s * s;
    return m.amplitude_m.norm() * std::min(2.0, turn * turn / 8);
  };
  const double bulge = (world_.acceleration(a, f) - world_.acceleration(b, g)).norm() * s * s / 8 +
                       shake(a) + shake(b);
  if (world_.is_half_space(a) || world_.is_half_space(b)) {
    const bool a_is_plane = world_.is_half_space(a);
    const int body = a_is_plane ? b : a;
    const Flight &flight = a_is_plane ? g : f, &plane = a_is_plane ? f : g;
    const Vector3d normal = plane.world_from_body * Vector3d::UnitZ();
    const int floor = a_is_plane ? a : b;
    const auto height = [&](double t) {
      return normal.dot(world_.position(body, flight, t) - world_.position(floor, plane, t));
    };
    return std::min(height(low), height(high)) - bulge <= world_.radius(body) * (1 + kNegligible);
  }
  const Vector3d from = world_.position(a, f, low) - world_.position(b, g, low),
                 way = world_.position(a, f, high) - world_.position(b, g, high) - from;
  const double length = way.squaredNorm(),
               part = length > 0 ? std::clamp(-from.dot(way) / length, 0.0, 1.0) : 0.0;
  return (from + part * way).norm() <=
         (world_.radius(a) + world_.radius(b)) * (1 + kNegligible) + bulge;
}

bool FlightImpactDetection::may_meet_on_segment(int a, const Flight& f, int b, const Flight& g,
                                                double low, double high) const {
  struct Corners {
    Vector3d low = Vector3d::Constant(kInfinity), high = Vector3d::Constant(-kInfinity);
  };
  const auto way = [&](int body, const Flight& flight) {
    Corners box;
    world_.extend_by_path(body, flight, low, high, box.low, box.high);
    return box;
  };
  if (world_.is_half_space(a) || world_.is_half_space(b)) {
    const bool a_is_plane = world_.is_half_space(a);
    const int body = a_is_plane ? b : a;
    const Corners box = a_is_plane ? way(b, g) : way(a, f);
    const Flight& plane = a_is_plane ? f : g;
    const Vector3d normal = plane.world_from_body * Vector3d::UnitZ(),
                   middle = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
    return normal.dot(middle - plane.com_world) - normal.cwiseAbs().dot(half) <=
           world_.radius(body) * (1 + kNegligible);
  }
  const Corners of_a = way(a, f), of_b = way(b, g);
  const Vector3d apart =
      (of_a.low - of_b.high).cwiseMax(of_b.low - of_a.high).cwiseMax(Vector3d::Zero());
  return apart.norm() <= (world_.radius(a) + world_.radius(b)) * (1 + kNegligible);
}

void FlightImpactDetection::require_searchable(int body, const Flight& flight,
                                               double duration) const {
  if (flight.segment >= 0 || world_.is_ball(body)) return;
  const double turn = flight.omega_body.norm() * duration;
  if (!(turn > kMostTurning)) return;
  throw StoppedRun(fmt::format(
      "body '{}' turns {:.3g} rad a step of {} s, too far to find its collisions: "
      "make the step (\"step_s\") shorter or the body slower",
      world_.world().bodies[static_cast<std::size_t>(body)].name, turn, step_in_words(duration)));
}

// The limits of windows are fixed; within a window, each smooth part of the motion is searched at
// once. So the result depends on the two flights alone.
double FlightImpactDetection::in_windows(int a, const Flight& f, int b, const Flight& g,
                                         double from, double to, CheckCost& cost) const {
  // one order of the bodies, so that the result has one rounding
  if (a > b) return in_windows(b, g, a, f, from, to, cost);
  const double begin = std::max(f.begin, g.begin);
  const bool of_pieces = f.segment >= 0 || g.segment >= 0;
  // A pair that stays apart in all requested windows is not searched in each of them.
  if (const std::int64_t first = window_of(std::max(from, begin));
      !of_pieces && window_begin(first + 1) < to && to < kInfinity) {
    const std::int64_t last = window_of(to);
    if (!may_meet(a, f, b, g, std::max(begin, window_begin(first)), window_begin(last + 1))) {
      ++cost.pair_checks;
      return kInfinity;
    }
  }
  const collision::ImpactOptions options{root_finder_};
  std::optional<collision::Motion> motion_a, motion_b;
  for (std::int64_t k = window_of(std::max(from, begin)); window_begin(k) < to; ++k) {
    const double high = window_begin(k + 1);
    for (double low = std::max(begin, window_begin(k)), end = low; low < high && low < to;
         low = end) {
      end = of_pieces ? world_.smooth_until(g, low, world_.smooth_until(f, low, high)) : high;
      if (!(end > low)) return kInfinity;  // one of the flights has ended
      if (!(end > from)) continue;
      ++cost.pair_checks;
      if (may_meet(a, f, b, g, low, end)) {
        if (!motion_a || of_pieces) {
          motion_a = world_.motion_from(a, f, low);
          motion_b = world_.motion_from(b, g, low);
        }
        require_searchable(a, f, end - low);
        require_searchable(b, g, end - low);
        const auto impact = collision::first_impact(world_.shape(a), *motion_a, world_.shape(b),
                                                    *motion_b, low, end, options, &cost.narrow);
        if (impact) return impact->time;
      }
    }
  }
  return kInfinity;
}

}  // namespace tumble::engines
