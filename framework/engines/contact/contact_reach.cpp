#include "framework/engines/contact/contact_reach.h"

#include <algorithm>
#include <utility>

#include "framework/collision/gap.h"
#include "framework/engines/contact/contact_constants.h"

namespace tumble::engines {

void ContactReach::clear() {
  speeds_.clear();
  bends_.clear();
  reach_of_.clear();
}

double ContactReach::of(Pair pair) const {
  if (const double* known = reach_of_.find(pair)) return *known;
  return farthest(pair);
}

// The same from speeds alone.
double ContactReach::farthest(Pair pair) const {
  const double h = moving_.target() - moving_.time();
  const double size = geometry_.size_of(pair);
  const double way =
      (speeds_.empty() ? moving_.fastest_in_step(pair.first) + moving_.fastest_in_step(pair.second)
                       : speeds_[pair.first] + speeds_[pair.second]) *
      h;
  return std::min(kContact.reach * size, way) + kContact.open_band * geometry_.margin(pair);
}

// Where impacts are solved in the step, a body may be as fast by its end as any that can meet it.
// [m/s], by body
std::vector<double> ContactReach::speeds_about(const std::vector<Pair>& candidates) const {
  std::vector<double> speeds(moving_.size(), 0.0);
  std::vector<char> meets(moving_.size(), 0);
  for (const auto& [a, b] : candidates) meets[a] = meets[b] = 1;
  for (int i = 0; i < moving_.size(); ++i)
    for (const double t : {moving_.time(), moving_.target()}) {
      if (!meets[i] || (!moving_.can_move(i) && !moving_.is_driven(i))) continue;
      const collision::MotionState state = moving_.motion_at(i, t);
      speeds[i] = std::max(
          speeds[i], state.velocity_world.norm() +
                         (moving_.shape(i).is_half_space()
                              ? 0.0
                              : state.omega_world.norm() * moving_.shape(i).bounding_radius()));
    }
  std::vector<double> about = speeds;
  for (const auto& [a, b] : candidates) {
    about[a] = std::max(about[a], speeds[b]);
    about[b] = std::max(about[b], speeds[a]);
  }
  for (int i = 0; i < moving_.size(); ++i)
    if (!moving_.can_move(i)) about[i] = speeds[i];
  return about;
}

// How much nearer than on their paths without contacts impacts may bring the two. [m]
double ContactReach::bend(Pair pair) const {
  return kContact.levers * (bends_[pair.first] + bends_[pair.second]);
}

// How much nearer any two points of the two come along a normal in the step, at most. [m]
double ContactReach::way(Pair pair, const Vector3d& normal_b_to_a_world) const {
  const Vector3d& n = normal_b_to_a_world;
  const double h = moving_.target() - moving_.time();
  double speed = 0.0;
  for (const auto& [index, sign] : {std::pair{pair.first, -1.0}, std::pair{pair.second, 1.0}}) {
    const Velocity& velocity = velocities_[index];
    speed += sign * n.dot(velocity.linear_world);
    if (!moving_.shape(index).is_half_space())
      speed += velocity.angular_world.cross(n).norm() * moving_.shape(index).bounding_radius();
  }
  return h * std::max(0.0, speed);
}

Vector3d ContactReach::velocity_of_point(int body, const Vector3d& point_world) const {
  return velocities_[body].linear_world +
         velocities_[body].angular_world.cross(point_world - moving_.state(body).com_world);
}

bool ContactReach::may_close(Pair pair, const collision::ManifoldPoint& point, double time) const {
  const Vector3d at = geometry_.point_of(pair, point);
  const double approach = point.normal_b_to_a_world.dot(velocity_of_point(pair.second, at) -
                                                        velocity_of_point(pair.first, at));
  return point.gap <=
         time * std::max(0.0, approach) + bend(pair) + 2 * geometry_.large_island_margin(pair);
}

// Along the normal of their gap two solids are
// apart at the step's start, and without contacts at its end: between the two they come nearer by
// what turning bends. Impacts of the step, which the pairs that would overlap at its end have, take
// bodies off such paths, and with them pairs together that would pass each other; by about as much
// as an impact takes off.
std::vector<ContactReach::Pair> ContactReach::look(const std::vector<Pair>& candidates,
                                                   const std::set<Pair>& persistent,
                                                   const std::function<bool(Pair)>& plastic) {
  struct Near {
    Pair pair;
    double distance, reach;  // [m]
  };
  reach_of_.clear();
  speeds_ = speeds_about(candidates);
  bends_.assign(static_cast<std::size_t>(moving_.size()), 0.0);
  velocities_.resize(static_cast<std::size_t>(moving_.size()));
  std::vector<char> known(velocities_.size(), 0);
  for (const Pair& pair : candidates)
    for (const int index : {pair.first, pair.second}) {
      if (std::exchange(known[index], 1)) continue;
      const Body body = moving_.body_at_impact(index);
      velocities_[index] = {body.velocity_world, body.omega_world};
    }
  std::vector<Near> near;
  std::vector<Pair> pairs;
  for (const Pair& pair : candidates) {
    const auto& [a, b] = pair;
    if (!persistent.contains(pair) && !plastic(pair)) continue;
    const double within = farthest(pair);
    if (geometry_.least_gap_of(pair, moving_.states()) > within) continue;
    const collision::CollisionShape &shape_a = moving_.shape(a), &shape_b = moving_.shape(b);
    if (!collision::has_separations(shape_a, shape_b)) {
      if (!geometry_.is_within(pair, moving_.states(), within)) continue;
      pairs.push_back(pair);
      near.push_back({pair, 0.0, within});
      continue;
    }
    const auto start = collision::largest_separation(shape_a, geometry_.pose(a, moving_.states()),
                                                     shape_b, geometry_.pose(b, moving_.states()),
                                                     moving_.pair_cache(a, b), within);
    if (!start) continue;
    pairs.push_back(pair);
    const Vector3d& n = start->normal_b_to_a_world;
    const double end =
        collision::separation_along(shape_a, moving_.pose_at(a, moving_.target()), shape_b,
                                    moving_.pose_at(b, moving_.target()), n);
    if (end < 0)
      for (const int body : {a, b})
        if (moving_.can_move(body)) bends_[body] = std::max(bends_[body], start->distance - end);
    near.push_back(
        {pair, std::min(start->distance, end) - chord_depth(a) - chord_depth(b), way(pair, n)});
  }
  for (const Near& of : near) {
    const double room = bend(of.pair) + 2 * geometry_.large_island_margin(of.pair);
    if (of.distance <= room || persistent.contains(of.pair))
      reach_of_.enter(of.pair, std::min(farthest(of.pair), of.reach + room));
  }
  return pairs;
}

// How far a point of a body that turns is from the chord of its arc in the step, at most. [m]
double ContactReach::chord_depth(int body) const {
  if (!moving_.can_move(body)) return 0.0;
  const double turn = (moving_.target() - moving_.time()) * velocities_[body].angular_world.norm();
  return 0.125 * turn * turn * moving_.shape(body).bounding_radius();
}

}  // namespace tumble::engines
