#include "framework/engines/sequential_impacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace tumble::engines {
namespace {

// Approach slower than this part of the fastest one is what rounding leaves of "not approaching"; so is what rounding leaves of
// the speeds along the surface that cancel in it (a ball sliding in a groove).
constexpr double kRoundOffOfSpeed = 1e-13;
constexpr double kRoundOffOfSliding = 64 * std::numeric_limits<double>::epsilon();
constexpr int kMostRounds = 10000;  // restitution 0.99 in a row of 50 balls takes some hundred

// Of the rest speed: pushes of touching pairs approach it together, each round by a part of what is missing.
constexpr double kFastEnough = 0.5;
constexpr int kMostPushes = 200;

Contact contact_of(const TouchingPair& pair, const Vector3d& point_world) { return {point_world, pair.gap.normal_b_to_a_world}; }

struct Approach {
  double velocity;      // [m/s], negative when approaching
  Vector3d point_world;
};

// The middle counts first, so that a flat landing does not tip over its corners in turn.
Approach fastest_approach(const Laws& laws, const TouchingPair& pair, const Body& a, const Body& b, double threshold) {
  Approach fastest{std::numeric_limits<double>::infinity(), pair.points_world[0]};
  for (const Vector3d& point : pair.points_world) {
    const double velocity = laws.relative_normal_velocity(contact_of(pair, point), a, b);
    if (velocity < fastest.velocity) fastest = {velocity, point};
    if (&point == &pair.points_world[0] && velocity < -threshold) break;
  }
  return fastest;
}

// Not by the law that is being judged: a record of what the impulse did.
double normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  const auto of_point = [&](const Body& body) -> Vector3d { return body.velocity_world + body.omega_world.cross(contact.point_world - body.com_world); };
  return contact.normal_b_to_a_world.dot(of_point(a) - of_point(b));
}

double speed_at(const Body& body, const Vector3d& point_world) {
  return body.velocity_world.norm() + body.omega_world.norm() * (point_world - body.com_world).norm();
}

// By how much a unit impulse at the contact changes the relative normal velocity. [1/kg]
double compliance(const Contact& contact, const Body& body) {
  const Vector3d arm = contact.point_world - body.com_world;
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  const Vector3d turn_body = R.transpose() * arm.cross(contact.normal_b_to_a_world);
  return body.inertia.inverse_mass + turn_body.dot(body.inertia.inverse_inertia_body * turn_body);
}

}  // namespace

struct SequentialImpacts::Work {
  MovingWorld& moving;
  std::map<int, Body> bodies;     // as they are between impulses
  std::set<int> changed;
  Resolution result;

  Body& body(int index) {
    const auto found = bodies.find(index);
    return found != bodies.end() ? found->second : bodies.emplace(index, moving.body_at_impact(index)).first->second;
  }

  // `impulse` along the normal on A, its opposite on B.
  void push(const Laws& laws, const TouchingPair& pair, const Contact& contact, double impulse) {
    for (const auto& [index, size] : {std::pair{pair.a, impulse}, std::pair{pair.b, -impulse}}) {
      Body& pushed = body(index);
      if (pushed.inertia.inverse_mass == 0.0) continue;
      if (moving.resting(index)) moving.wake(index);   // its mass was part of the impulse: it takes its share
      const Velocity after = laws.apply_impulse(pushed, size * contact.normal_b_to_a_world, contact.point_world);
      pushed.velocity_world = after.linear_world;
      pushed.omega_world = after.angular_world;
      changed.insert(index);
    }
  }

  void write_back() {
    for (const int index : changed) {
      const Body& pushed = bodies.at(index);
      RigidBodyState state = moving.state(index);
      state.momentum_world = pushed.inertia.mass * pushed.velocity_world;
      state.angular_momentum_world = angular_momentum_of(pushed.omega_world, pushed.world_from_body, pushed.inertia);
      moving.set_state(index, state);
    }
  }
};

bool SequentialImpacts::stays(const World& world, const TouchingPair& pair, double approach_speed) const {
  const double restitution = std::min(world.bodies[pair.a].restitution, world.bodies[pair.b].restitution);
  return contact_rest_speed_ && laws_.ends_in_contact(approach_speed, restitution, *contact_rest_speed_);
}

bool SequentialImpacts::collide(Work& work, const TouchingPair& pair, double threshold) {
  Body& a = work.body(pair.a);
  Body& b = work.body(pair.b);
  const auto [approach, point_world] = fastest_approach(laws_, pair, a, b, threshold);
  if (!(approach < -threshold)) return false;
  const Contact contact = contact_of(pair, point_world);
  double restitution = std::min(work.moving.world().bodies[pair.a].restitution, work.moving.world().bodies[pair.b].restitution);
  if (stays(work.moving.world(), pair, -approach)) restitution = 0.0;
  const double impulse = laws_.collision_impulse(contact, a, b, restitution);
  work.push(laws_, pair, contact, impulse);
  ++counters_.impulses;
  work.result.events.push_back({work.moving.time(), EventKind::kCollision, pair.a, pair.b, contact.point_world,
                                contact.normal_b_to_a_world, impulse, approach, normal_velocity(contact, a, b)});
  return true;
}

bool SequentialImpacts::push_pair_apart(Work& work, const TouchingPair& pair) {
  const auto [rate, point_world] = fastest_approach(laws_, pair, work.body(pair.a), work.body(pair.b), rules_.rest_speed);
  if (rate >= kFastEnough * rules_.rest_speed) return false;
  const Contact contact = contact_of(pair, point_world);
  const double yielding = compliance(contact, work.body(pair.a)) + compliance(contact, work.body(pair.b));
  work.push(laws_, pair, contact, (rules_.rest_speed - rate) / yielding);
  ++counters_.micro_impacts;
  return true;
}

void SequentialImpacts::push_apart(MovingWorld& moving, const std::vector<TouchingPair>& touching, const std::vector<TouchingPair>& micro_impacts) {
  if (micro_impacts.empty()) return;
  Work work{moving, {}, {}, {}};
  const auto had_micro_impact = [&](const TouchingPair& pair) {
    return std::any_of(micro_impacts.begin(), micro_impacts.end(), [&](const TouchingPair& m) { return m.a == pair.a && m.b == pair.b; });
  };
  bool again = true;
  for (int round = 0; again && round < kMostPushes; ++round) {
    again = false;
    for (const TouchingPair& pair : touching)
      if (had_micro_impact(pair) || work.changed.contains(pair.a) || work.changed.contains(pair.b)) again = push_pair_apart(work, pair) || again;
  }
  work.write_back();
}

Resolution SequentialImpacts::resolve(MovingWorld& moving, const std::vector<TouchingPair>& pairs, std::size_t trigger) {
  Work work{moving, {}, {}, {}};
  double fastest = 0.0, sliding = 0.0;
  for (const TouchingPair& pair : pairs)
    for (const Vector3d& point : pair.points_world) {
      fastest = std::max(fastest, std::abs(laws_.relative_normal_velocity(contact_of(pair, point), work.body(pair.a), work.body(pair.b))));
      sliding = std::max({sliding, speed_at(work.body(pair.a), point), speed_at(work.body(pair.b), point)});
    }
  const double threshold = std::max(kRoundOffOfSpeed * fastest, kRoundOffOfSliding * sliding);

  bool again = true;
  int rounds = 0;
  while (again && ++rounds < kMostRounds) {
    again = false;
    for (const TouchingPair& pair : pairs) again = collide(work, pair, threshold) || again;
  }
  work.result.settled = !again;

  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const TouchingPair& pair = pairs[k];
    const auto [last, first_time] = last_meeting_.try_emplace({pair.a, pair.b}, -std::numeric_limits<double>::infinity());
    double approach = 0.0;
    bool hit = false;
    for (const Event& event : work.result.events) {
      if (event.body_a != pair.a || event.body_b != pair.b) continue;
      hit = true;
      approach = std::max(approach, -event.normal_velocity_before);
    }
    if (!hit && k != trigger) continue;
    const bool in_vain = work.result.events.empty();
    const bool soon_again = moving.time() - last->second < rules_.micro_interval && approach < rules_.rest_speed;
    if (in_vain || soon_again) work.result.micro_impacts.push_back(pair);
    last->second = moving.time();
  }
  work.write_back();
  ++counters_.impacts;
  return work.result;
}

}  // namespace tumble::engines
