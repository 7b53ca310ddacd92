#include "framework/engines/timewarp/taught_search.h"

#include <algorithm>
#include <limits>

#include "framework/collision/gap.h"
#include "framework/core/numbers.h"

namespace tumble::engines {

Stamp stamp_of(const EventStamp& key) {
  const WorkKind kind = key.kind == StampKind::kCallback  ? WorkKind::kCallback
                        : key.kind == StampKind::kProcess ? WorkKind::kGroup
                                                          : WorkKind::kCollision;
  return {key.time, key.microstep, kind, key.body_a, key.body_b};
}

std::vector<std::int32_t> bodies_that_move_with(const FlightWorld& world,
                                                const std::vector<BegunFlight>& flights) {
  std::vector<std::int32_t> bodies;
  for (const BegunFlight& flight : flights)
    if (world.can_move(flight.body))
      for (const int member : world.members(flight.body, flight.flight)) bodies.push_back(member);
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return bodies;
}

std::optional<FoundImpact> find_impact(FlightRun& run, const TaughtLogicalProcess& of_a,
                                       const TaughtLogicalProcess& of_b, double from, double to) {
  const FlightWorld& world = run.world();
  const int a = of_a.body(), b = of_b.body();
  // The flights of a body: states of one version belong to one flight.
  struct Part {
    Flight flight;
    double end;                         // [s]
    std::optional<EventStamp> end_key;  // the event that ended it
  };
  const auto parts_of = [&](const TaughtLogicalProcess& process) {
    const int body = process.body();
    std::vector<Part> parts;
    if (!world.can_move(body))
      return std::vector<Part>{{world.first_flight(body), kInfinity, std::nullopt}};
    for (const KeptState& state : process.states()) {
      if (!parts.empty() && parts.back().flight.version == state.flight.version) continue;
      if (!parts.empty()) {
        parts.back().end = state.flight.begin;
        parts.back().end_key = state.began;
      }
      parts.push_back({state.flight, kInfinity, std::nullopt});
    }
    return parts;
  };
  std::optional<FoundImpact> first;
  for (const Part& f : parts_of(of_a))
    for (const Part& g : parts_of(of_b)) {
      const double low = std::max({from, f.flight.begin, g.flight.begin}),
                   high = std::min({to, f.end, g.end});
      if (low > high) continue;
      const double time = run.impacts().first_impact(a, f.flight, b, g.flight, low, high, run.cost);
      if (!(time >= low && time <= high)) continue;
      const EventStamp key = key_of_impact(a, f.flight, b, g.flight, time);
      // One of them was hit earlier, or this very impact has been executed.
      if ((f.end_key && !(key < *f.end_key)) || (g.end_key && !(key < *g.end_key))) continue;
      if (!first || key < first->key)
        first = FoundImpact{key, f.flight.version, g.flight.version,
                            bodies_that_move_with(world, {{a, f.flight}, {b, g.flight}})};
    }
  return first;
}

CheckFinding closeness(const FlightWorld& world, int a, const Flight& f, int b, const Flight& g,
                       double t) {
  CheckFinding finding;
  const double at_a = until_end(world, f, t), at_b = until_end(world, g, t);
  const collision::MotionState x = world.motion_at(a, f, at_a), y = world.motion_at(b, g, at_b);
  const collision::MotionBounds of_a = world.bounds(a, f, at_a), of_b = world.bounds(b, g, at_b);
  finding.gap = std::max(
      0.0, collision::compute_gap(world.shape(a), x.pose, world.shape(b), y.pose).distance);
  // a half-space has no radius and does not rotate
  const auto turning = [&](int body, double rate) {
    return rate > 0 ? rate * world.radius(body) : 0.0;
  };
  finding.closing_speed = (x.velocity_world - y.velocity_world).norm() +
                          turning(a, of_a.angular_speed) + turning(b, of_b.angular_speed);
  finding.closing_acceleration =
      (of_a.acceleration_world - of_b.acceleration_world).norm() + of_a.acceleration_deviation +
      of_b.acceleration_deviation +
      turning(a, of_a.angular_speed * of_a.angular_speed + of_a.angular_acceleration) +
      turning(b, of_b.angular_speed * of_b.angular_speed + of_b.angular_acceleration);
  return finding;
}

}  // namespace tumble::engines
