#include "framework/engines/events/flight_frames.h"

#include <algorithm>
#include <limits>
#include <map>

#include "framework/collision/gap.h"
#include "framework/collision/sweep.h"
#include "framework/core/numbers.h"
#include "framework/effects/invariants.h"

namespace tumble::engines {
namespace {

constexpr std::size_t kFew = 200;  // movable bodies: up to this number every pair is checked
// of the largest movable body's radius: the first margin of boxes where there are many
constexpr double kFirstReach = 0.05;
// m: where all are point masses; it grows until it is enough, so its size is no matter
constexpr double kFirstReachOfPoints = 1e-3;

double smaller_gap(const FlightWorld& world, const std::vector<RigidBodyState>& states, int i,
                   int j, double smallest) {
  if (!world.may_collide(i, j)) return smallest;
  const double reach = smallest + world.radius(i) + world.radius(j);
  if (reach < kInfinity &&
      (states[i].com_world - states[j].com_world).squaredNorm() > reach * reach)
    return smallest;
  const auto pose = [&](int k) {
    return collision::Pose{states[k].com_world, states[k].world_from_body};
  };
  return std::min(smallest,
                  collision::gap_distance(world.shape(i), pose(i), world.shape(j), pose(j)));
}

// Bounding balls whose gap is at most `reach` have boxes that overlap when each is extended by half
// of it.
double gap_of_many(const FlightWorld& world, const std::vector<RigidBodyState>& states) {
  double largest = 0.0;
  for (const int i : world.movers()) largest = std::max(largest, world.radius(i));
  for (double reach = largest > 0 ? kFirstReach * largest : kFirstReachOfPoints;; reach *= 4) {
    std::vector<collision::SweptBox> boxes;
    for (int i = 0; i < world.size(); ++i) {
      const Vector3d half = Vector3d::Constant(world.radius(i) + 0.5 * reach);
      boxes.push_back({states[i].com_world - half, states[i].com_world + half, world.can_move(i)});
    }
    double smallest = kInfinity;
    const auto pairs = collision::overlapping_pairs(boxes);
    for (const auto& [i, j] : pairs) smallest = smaller_gap(world, states, i, j, smallest);
    if (smallest <= reach || pairs.size() > 50 * world.movers().size()) return smallest;
  }
}

double smallest_gap(const FlightWorld& world, const std::vector<RigidBodyState>& states) {
  if (world.movers().size() > kFew) return gap_of_many(world, states);
  double smallest = kInfinity;
  for (int i = 0; i < world.size(); ++i)
    for (int j = i + 1; j < world.size(); ++j)
      smallest = smaller_gap(world, states, i, j, smallest);
  return smallest;
}

}  // namespace

Frame frame_of(const FlightWorld& world, double t, const FlightOf& flight_of,
               std::vector<RigidBodyState>& states) {
  Frame frame;
  frame.time = t;
  states.clear();
  std::map<int, std::vector<RigidBodyState>> shown;  // by segment: the states of its members
  for (int i = 0; i < world.size(); ++i) {
    // A member of an island: its state on the segment.
    const Flight& flight = flight_of(i);
    // position correction moves its path without a velocity (SmoothPath::Momenta): the momentum of
    // the state counts
    if (flight.segment >= 0) {
      const Inertia& inertia = world.world().bodies[i].inertia;
      IslandSegments& segments = world.all_processes().segments();
      const auto [members, is_new] = shown.try_emplace(flight.segment);
      if (is_new) members->second = segments.shown_at(flight.segment, t);
      states.push_back(members->second[segments.place(flight.segment, i)]);
      const RigidBodyState& state = states.back();
      frame.poses.push_back({state.com_world, state.world_from_body,
                             inertia.inverse_mass * state.momentum_world,
                             omega_of(state, inertia)});
      continue;
    }
    // A body in free flight, or immovable.
    const collision::MotionState now = world.motion_at(i, flight, t);
    frame.poses.push_back(
        {now.pose.com_world, now.pose.world_from_body, now.velocity_world, now.omega_world});
    states.push_back(
        {now.pose.com_world, now.pose.world_from_body, Vector3d::Zero(), Vector3d::Zero()});
    if (!world.can_move(i)) continue;
    const Inertia& inertia = world.world().bodies[i].inertia;
    states.back().momentum_world = inertia.mass * now.velocity_world;
    states.back().angular_momentum_world =
        now.pose.world_from_body *
        (inertia.inertia_body * (now.pose.world_from_body.conjugate() * now.omega_world));
  }
  // Sums over all bodies.
  const Invariants sums = invariants_of(world.world(), states);
  frame.kinetic_energy = sums.kinetic_energy;
  frame.potential_energy = sums.potential_energy;
  frame.momentum_world = sums.momentum_world;
  frame.angular_momentum_world = sums.angular_momentum_world;
  frame.smallest_gap = smallest_gap(world, states);
  return frame;
}

}  // namespace tumble::engines
