#include "framework/engines/events/flight_impact_response.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/impact_bodies.h"
#include "framework/engines/contact/impact_law.h"
#include "framework/engines/contact/impact_detection.h"
#include "framework/engines/contact/impact_normal.h"

namespace tumble::engines {
namespace {

constexpr int kMostPairNudges = 20;

// Change of the point's velocity along a direction by a unit impulse at the point. [1/kg]
double compliance(const Contact& contact, const Body& body) {
  if (body.inertia.inverse_mass == 0.0) return 0.0;
  const Vector3d turn_body =
      body.world_from_body.conjugate() *
      (contact.point_world - body.com_world).cross(contact.normal_b_to_a_world);
  return body.inertia.inverse_mass + turn_body.dot(body.inertia.inverse_inertia_body * turn_body);
}

}  // namespace

struct FlightImpactResponse::Work {
  Discontinuity result;
  const Flight& f;
  const Flight& g;
  Body a, b;
  collision::Gap gap;
  // the centre of the region of contact, then its corners where it is more than a point
  std::vector<Vector3d> points_world;
  double fastest = 0.0;  // approach before the first impulse [m/s]
  bool any_event = false;

  void record(const Event& event) {
    if (any_event)
      result.more.push_back(event);
    else
      result.first = event;
    any_event = true;
  }
  Contact contact_at(const Vector3d& point_world) const {
    return {point_world, gap.normal_b_to_a_world};
  }
  TouchedRegion region() const { return {gap.normal_b_to_a_world, points_world}; }
};

void FlightImpactResponse::push(Work& work, const Contact& contact, double impulse) const {
  for (const auto& [body, size] : {std::pair{&work.a, impulse}, std::pair{&work.b, -impulse}}) {
    if (body->inertia.inverse_mass == 0.0) continue;
    const Velocity after =
        laws_.apply_impulse(*body, size * contact.normal_b_to_a_world, contact.point_world);
    body->velocity_world = after.linear_world;
    body->omega_world = after.angular_world;
  }
}

void FlightImpactResponse::collide(Work& work) const {
  const int a = work.result.key.body_a, b = work.result.key.body_b;
  const double restitution = std::min(world_.restitution(a), world_.restitution(b));
  ApproachThreshold threshold;
  threshold.look(laws_, work.region(), work.a, work.b);
  work.fastest = threshold.fastest();
  for (int round = 0;; ++round) {
    const auto [approach, point] =
        fastest_approach(laws_, work.region(), work.a, work.b, threshold.value());
    if (!(approach < -threshold.value())) return;
    if (round == kMostImpactRounds) throw StoppedRun(left_approaching_message(laws_));
    const Contact contact = work.contact_at(point);
    const double impulse = laws_.collision_impulse(contact, work.a, work.b, restitution);
    const Velocity before_a{work.a.velocity_world, work.a.omega_world},
        before_b{work.b.velocity_world, work.b.omega_world};
    push(work, contact, impulse);
    EnergyOfImpact energy;
    const Vector3d driven = !world_.can_move(a)   ? work.a.velocity_world
                            : !world_.can_move(b) ? work.b.velocity_world
                                                  : Vector3d(Vector3d::Zero());
    if (world_.can_move(a))
      energy.add(work.a.inertia, work.a.world_from_body, before_a,
                 {work.a.velocity_world, work.a.omega_world}, driven);
    if (world_.can_move(b))
      energy.add(work.b.inertia, work.b.world_from_body, before_b,
                 {work.b.velocity_world, work.b.omega_world}, driven);
    work.result.impulse += impulse;
    work.record({work.result.key.time, EventKind::kCollision, a, b, contact.point_world,
                 contact.normal_b_to_a_world, impulse, approach,
                 normal_velocity(contact, work.a, work.b), energy.change,
                 energy.excess(work_of_impulse(impulse, approach, restitution),
                               rules_.restitution_threshold)});
  }
}

// Without persistent contacts a pair that gravity or rotation presses together would collide
// infinitely often in finite time: it gets a separation impulse.
void FlightImpactResponse::hop(Work& work) const {
  const auto send = [&](const Vector3d& point) {
    const Contact contact = work.contact_at(point);
    const double rate = normal_velocity(contact, work.a, work.b);
    if (rate >= kFastEnough * rules_.restitution_threshold) return false;
    push(work, contact,
         (rules_.restitution_threshold - rate) /
             (compliance(contact, work.a) + compliance(contact, work.b)));
    return true;
  };
  bool again = true;
  for (int round = 0; again && round < kMostPushes; ++round) {
    again = false;
    for (const Vector3d& point : work.points_world) again = send(point) || again;
  }
}

// Rest on a fixed support.
bool FlightImpactResponse::settle(Work& work, int body, int support) const {
  if (!world_.can_move(body) || !world_.is_still(support) || !world_.is_ball(body) ||
      world_.gravity_world().isZero(0.0))
    return false;
  const bool is_a = body == work.result.key.body_a;
  Body& mover = is_a ? work.a : work.b;
  const Vector3d up = is_a ? work.gap.normal_b_to_a_world : Vector3d(-work.gap.normal_b_to_a_world);
  const double rounding =
      kRoundOff * collision::gap_scale(world_.shape(work.result.key.body_a),
                                       {work.a.com_world, work.a.world_from_body},
                                       world_.shape(work.result.key.body_b),
                                       {work.b.com_world, work.b.world_from_body});
  if (!comes_to_rest({world_.gravity_world(), up, world_.radius(body), rounding,
                      mover.inertia.inertia_body, !mover.omega_world.isZero(0.0),
                      mover.velocity_world,
                      std::min(world_.restitution(body), world_.restitution(support)),
                      rules_.restitution_threshold, work.fastest}))
    return false;
  mover.velocity_world.setZero();
  mover.com_world -= work.gap.distance * up;
  const EventStamp& key = work.result.key;
  work.record({key.time, EventKind::kRest, key.body_a, key.body_b, work.gap.point_b_world,
               work.gap.normal_b_to_a_world, 0.0, 0.0});
  (is_a ? work.result.a : work.result.b).is_resting = true;
  return true;
}

// Removes the overlap that rounding has left by moving one body along the normal.
void FlightImpactResponse::remove_overlaps(Work& work) const {
  const int a = work.result.key.body_a, b = work.result.key.body_b;
  for (int round = 0; round < kMostPairNudges; ++round) {
    const collision::Gap gap =
        collision::compute_gap(world_.shape(a), {work.a.com_world, work.a.world_from_body},
                               world_.shape(b), {work.b.com_world, work.b.world_from_body});
    if (gap.distance >= 0) return;
    const bool moves_a = work.a.inertia.inverse_mass >= work.b.inertia.inverse_mass;
    Body& mover = moves_a ? work.a : work.b;
    const double way = -gap.distance + round * kEpsilon * mover.com_world.cwiseAbs().maxCoeff();
    mover.com_world += (moves_a ? way : -way) * gap.normal_b_to_a_world;
  }
}

Flight FlightImpactResponse::flight_of(const Work& work, int body, const Flight& before,
                                       const Body& now) const {
  if (!world_.can_move(body)) return before;
  const EventStamp& key = work.result.key;
  Flight flight = body == key.body_a ? work.result.a : work.result.b;
  flight.begin = key.time;
  flight.microstep = key.microstep;
  flight.partner = body == key.body_a ? key.body_b : key.body_a;
  flight.com_world = now.com_world;
  flight.velocity_world = now.velocity_world;
  flight.world_from_body = now.world_from_body;
  const double arm = world_.radius(body),
               change = (now.velocity_world - world_.velocity(body, before, key.time)).norm();
  // A push through the middle of a ball does not turn it, but for what rounding leaves of the
  // torque.
  const bool turns = !(world_.is_ball(body) && before.omega_body.isZero(0.0) &&
                       now.omega_world.norm() * arm <= kRoundOff * change);
  flight.omega_body = turns ? Vector3d(now.world_from_body.conjugate() * now.omega_world)
                            : Vector3d(Vector3d::Zero());
  if (!now.com_world.allFinite() || !now.velocity_world.allFinite() || !now.omega_world.allFinite())
    throw StoppedRun(fmt::format("body '{}': its state is not a number (impulses: {})",
                                 world_.world().bodies[body].name, laws_.impulse_source));
  return flight;
}

Discontinuity FlightImpactResponse::resolve_impact(const EventStamp& key, const Flight& f,
                                                   const Flight& g) const {
  const int a = key.body_a, b = key.body_b;
  Work work{{key, {}, {}, {}, 0.0, {}, {}, false},
            f,
            g,
            world_.body_at(a, f, key.time),
            world_.body_at(b, g, key.time),
            {},
            {},
            0.0,
            false};
  const collision::Pose pose_a{work.a.com_world, work.a.world_from_body},
      pose_b{work.b.com_world, work.b.world_from_body};
  const collision::CollisionShape &shape_a = world_.shape(a), &shape_b = world_.shape(b);
  work.gap = collision::compute_gap(shape_a, pose_a, shape_b, pose_b);
  work.gap.normal_b_to_a_world =
      normal_of_impact({world_.world().bodies[a],
                        world_.world().bodies[b],
                        shape_a,
                        shape_b,
                        {pose_a, work.a.velocity_world, work.a.omega_world},
                        {pose_b, work.b.velocity_world, work.b.omega_world}},
                       work.gap, rules_.restitution_threshold);
  work.points_world =
      touching_points(shape_a, pose_a, shape_b, pose_b, work.gap,
                      {world_.world().bodies[a].inertia.inverse_mass,
                       world_.world().bodies[b].inertia.inverse_mass},
                      kRoundOff * collision::gap_scale(shape_a, pose_a, shape_b, pose_b));
  collide(work);
  const bool rests = settle(work, a, b) || settle(work, b, a);
  const double last =
      std::max(f.partner == b ? f.begin : -kEpsilon, g.partner == a ? g.begin : -kEpsilon);
  const bool soon_again = last >= 0 && key.time - last < rules_.micro_interval &&
                          work.fastest < rules_.restitution_threshold;
  if (!rests && (soon_again || !work.any_event)) hop(work);
  if (!work.any_event)
    work.result.first = {key.time,
                         EventKind::kCollision,
                         a,
                         b,
                         work.points_world.front(),
                         work.gap.normal_b_to_a_world,
                         0.0,
                         0.0,
                         0.0};
  remove_overlaps(work);
  work.result.a = flight_of(work, a, f, work.a);
  work.result.b = flight_of(work, b, g, work.b);
  return std::move(work.result);
}

}  // namespace tumble::engines
