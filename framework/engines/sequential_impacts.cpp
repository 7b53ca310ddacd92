#include "framework/engines/sequential_impacts.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace tumble::engines {
namespace {

// Approach slower than this part of the fastest one is what rounding leaves of "not approaching".
constexpr double kRoundOffOfSpeed = 1e-13;
constexpr int kMostRounds = 10000;  // restitution 0.99 in a row of 50 balls takes some hundred

Contact contact_of(const TouchingPair& pair) {
  return {0.5 * (pair.gap.point_a_world + pair.gap.point_b_world), pair.gap.normal_b_to_a_world};
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
      if (pushed.inertia.inverse_mass == 0.0 || !moving.can_move(index)) continue;
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

bool SequentialImpacts::collide(Work& work, const TouchingPair& pair, double threshold) {
  Body& a = work.body(pair.a);
  Body& b = work.body(pair.b);
  const Contact contact = contact_of(pair);
  const double approach = laws_.relative_normal_velocity(contact, a, b);
  if (!(approach < -threshold)) return false;
  const double restitution = std::min(work.moving.world().bodies[pair.a].restitution, work.moving.world().bodies[pair.b].restitution);
  const double impulse = laws_.collision_impulse(contact, a, b, restitution);
  work.push(laws_, pair, contact, impulse);
  ++counters_.impulses;
  work.result.events.push_back({work.moving.time(), EventKind::kCollision, pair.a, pair.b, contact.point_world,
                                contact.normal_b_to_a_world, impulse, approach});
  return true;
}

void SequentialImpacts::push_apart(MovingWorld& moving, const TouchingPair& pair) {
  Work work{moving, {}, {}, {}};
  const Contact contact = contact_of(pair);
  const double rate = laws_.relative_normal_velocity(contact, work.body(pair.a), work.body(pair.b));
  if (rate >= rules_.rest_speed) return;
  const double impulse = (rules_.rest_speed - rate) / (compliance(contact, work.body(pair.a)) + compliance(contact, work.body(pair.b)));
  work.push(laws_, pair, contact, impulse);
  work.write_back();
  ++counters_.micro_impacts;
}

Resolution SequentialImpacts::resolve(MovingWorld& moving, const std::vector<TouchingPair>& pairs, std::size_t trigger) {
  Work work{moving, {}, {}, {}};
  double fastest = 0.0;
  for (const TouchingPair& pair : pairs)
    fastest = std::max(fastest, std::abs(laws_.relative_normal_velocity(contact_of(pair), work.body(pair.a), work.body(pair.b))));
  const double threshold = kRoundOffOfSpeed * fastest;

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
    const bool met = k == trigger || std::any_of(work.result.events.begin(), work.result.events.end(),
                                                 [&](const Event& e) { return e.body_a == pair.a && e.body_b == pair.b; });
    if (!met) continue;
    const bool in_vain = k == trigger && work.result.events.empty();
    if (in_vain || moving.time() - last->second < rules_.micro_interval) work.result.micro_impacts.push_back(pair);
    last->second = moving.time();
  }
  work.write_back();
  ++counters_.impacts;
  return work.result;
}

}  // namespace tumble::engines
