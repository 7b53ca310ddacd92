#include "framework/engines/events/tied_impacts.h"

#include <algorithm>

#include "framework/collision/gap.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/impact_law.h"
#include "framework/engines/contact/impact_normal.h"

namespace tumble::engines {
namespace {

// bodies, each of which is asked where it is at each impact: with more, walls alone are asked, and
// with more walls, nothing
constexpr std::size_t kMostAsked = 64;

}  // namespace

// Cheap, and wrong only by finding near what is far: by bounding balls, then by the other's box.
bool TiedImpacts::is_far(int body, const Vector3d& com_world, int other, double t,
                         const Flight& flight) const {
  const double reach = world_.radius(body) * (1 + kSixDigits);
  const Vector3d from_other = com_world - world_.position(other, flight, t);
  if (!world_.is_half_space(other)) {
    const double apart = reach + world_.radius(other) * (1 + kSixDigits);
    if (from_other.squaredNorm() > apart * apart) return true;
  }
  if (world_.can_move(other)) return false;
  const Vector3d there = flight.world_from_body.conjugate() * from_other;
  if (world_.is_half_space(other)) return there.z() > reach;
  const collision::BallNode& root = world_.shape(other).nodes().front();
  const double around = reach + world_.shape(other).radius();
  return ((there - root.center_body).cwiseAbs().array() >
          root.half_extents_body.array() * (1 + kSixDigits) + around)
      .any();
}

// Within what rounding of places and times leaves (ImpactDetection::touching_distance).
bool TiedImpacts::touch(int a, int b, double t, const FlightOf& before) const {
  const Body one = world_.body_at(a, before(a), t), two = world_.body_at(b, before(b), t);
  const collision::Pose pose_a{one.com_world, one.world_from_body},
      pose_b{two.com_world, two.world_from_body};
  const double touching =
      kRoundOff * collision::gap_scale(world_.shape(a), pose_a, world_.shape(b), pose_b) +
      kFewRoundings * kEpsilon * t * (one.velocity_world.norm() + two.velocity_world.norm());
  return collision::gap_distance(world_.shape(a), pose_a, world_.shape(b), pose_b, nullptr,
                                 touching) <= touching;
}

// Faster than what rests on a support meets it.
bool TiedImpacts::approach(int a, int b, double t, const FlightOf& before) const {
  const Body one = world_.body_at(a, before(a), t), two = world_.body_at(b, before(b), t);
  const collision::Pose pose_a{one.com_world, one.world_from_body},
      pose_b{two.com_world, two.world_from_body};
  const collision::Gap gap =
      collision::compute_gap(world_.shape(a), pose_a, world_.shape(b), pose_b);
  const std::vector<Vector3d> points = touching_points(
      world_.shape(a), pose_a, world_.shape(b), pose_b, gap,
      {world_.world().bodies[a].inertia.inverse_mass,
       world_.world().bodies[b].inertia.inverse_mass},
      kRoundOff * collision::gap_scale(world_.shape(a), pose_a, world_.shape(b), pose_b));
  return fastest_approach(laws_, {gap.normal_b_to_a_world, points}, one, two,
                          rules_.restitution_threshold)
             .velocity < -rules_.restitution_threshold;
}

std::vector<int> TiedImpacts::partners(int body, double t, const FlightOf& before) const {
  std::vector<int> found;
  const Vector3d com_world = world_.position(body, before(body), t);
  const auto ask = [&](int other) {
    if (other != body && !is_far(body, com_world, other, t, before(other)) &&
        world_.may_collide(body, other) &&
        touch(std::min(body, other), std::max(body, other), t, before))
      found.push_back(other);
  };
  if (static_cast<std::size_t>(world_.size()) <= kMostAsked)
    for (int other = 0; other < world_.size(); ++other) ask(other);
  else
    for (const int other : world_.obstacles()) ask(other);
  return found;
}

// Whether one of the two meets a third body, and they each other, before any impulse, or they end a
// row of four at least: there impulses can bring a body two impacts at once.
bool TiedImpacts::meets_another(const EventStamp& key, const FlightOf& before) const {
  bool is_longer = false;
  for (const int body : {key.body_a, key.body_b}) {
    if (!world_.can_move(body) || before(body).segment >= 0) continue;
    for (const int other : partners(body, key.time, before)) {
      if (other == key.body_a || other == key.body_b) continue;
      if (approach(std::min(body, other), std::max(body, other), key.time, before))
        return approach(key.body_a, key.body_b, key.time, before);
      is_longer = true;
    }
  }
  constexpr std::size_t kRow = 4;
  return is_longer && touching(key, before).size() >= kRow &&
         approach(key.body_a, key.body_b, key.time, before);
}

// The two, and what touches them directly or through others, ascending.
std::vector<int> TiedImpacts::touching(const EventStamp& key, const FlightOf& before) const {
  std::vector<int> bodies{key.body_a, key.body_b};
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (!world_.can_move(bodies[k])) continue;
    for (const int other : partners(bodies[k], key.time, before))
      if (std::find(bodies.begin(), bodies.end(), other) == bodies.end()) bodies.push_back(other);
  }
  std::sort(bodies.begin(), bodies.end());
  return bodies;
}

// Of two bodies that fly freely, or one that does and a wall; within processes an impact is watched
// where it is resolved.
void TiedImpacts::look_at_normal(const EventStamp& key, const FlightOf& before,
                                 RunWatch& watch) const {
  const int a = key.body_a, b = key.body_b;
  if (key.kind != StampKind::kCollision || key.microstep > 0 || b < 0 || before(a).segment >= 0 ||
      before(b).segment >= 0 || world_.is_half_space(a) || world_.is_half_space(b) ||
      watch.has_said(kNormalOfImpact, key.time))
    return;
  const Body one = world_.body_at(a, before(a), key.time),
             two = world_.body_at(b, before(b), key.time);
  const MeetingBodies bodies{
      world_.world().bodies[a],
      world_.world().bodies[b],
      world_.shape(a),
      world_.shape(b),
      {{one.com_world, one.world_from_body}, one.velocity_world, one.omega_world},
      {{two.com_world, two.world_from_body}, two.velocity_world, two.omega_world}};
  if (bodies.shape_a.is_ball() || bodies.shape_b.is_ball()) return;
  const collision::Gap gap = collision::compute_gap(bodies.shape_a, bodies.motion_a.pose,
                                                    bodies.shape_b, bodies.motion_b.pose);
  watch_normal(key.time, bodies, gap, normal_of_impact(bodies, gap, rules_.restitution_threshold),
               watch);
}

void TiedImpacts::look(const EventStamp& key, const FlightOf& before, RunWatch& watch) {
  look_at_normal(key, before, watch);
  const std::size_t asked =
      static_cast<std::size_t>(world_.size()) <= kMostAsked ? 0 : world_.obstacles().size();
  if (key.kind != StampKind::kCollision || key.microstep > 0 || asked > kMostAsked ||
      watch.has_said(kOrderOfImpacts, key.time) || !meets_another(key, before))
    return;
  std::vector<int> still;
  ProcessState state;
  state.time = key.time;
  for (const int body : touching(key, before)) {
    if (!world_.can_move(body)) {
      still.push_back(body);
      continue;
    }
    if (before(body).segment >= 0) return;
    state.members.push_back(body);
    state.states.push_back(world_.state(body, before(body), key.time));
  }
  if (!entries_) entries_.emplace(world_.world());
  RunCounters counters;
  ProcessWorld part(
      world_.world(), *entries_, [this](int body) { return &world_.shape(body); }, laws_, rules_,
      counters, state.members, still);
  try {
    part.watch_order({key.body_a, key.body_b}, state);
  } catch (const OutOfTime&) {
    throw;
  } catch (const StoppedRun&) {
    // the impacts of the run itself have gone well
  }
  for (const std::string& words : counters.watch.notices())
    watch.say(kOrderOfImpacts, key.time, words);
}

}  // namespace tumble::engines
