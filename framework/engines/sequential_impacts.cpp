#include "framework/engines/sequential_impacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "framework/dynamics/contact_problem.h"

namespace tumble::engines {
namespace {

// Approach slower than this part of the fastest one is what rounding leaves of "not approaching"; so is what rounding leaves of
// the speeds along the surface that cancel in it (a ball sliding in a groove).
constexpr double kRoundOffOfSpeed = 1e-13;
constexpr double kRoundOffOfSliding = 64 * std::numeric_limits<double>::epsilon();
constexpr int kRoundsAmongContacts = 60;   // bodies in lasting contact pass a blow on in ever smaller parts
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


double speed_at(const Body& body, const Vector3d& point_world) {
  return body.velocity_world.norm() + body.omega_world.norm() * (point_world - body.com_world).norm();
}

// By how much a unit impulse at the point changes the velocity of the point along a direction. [1/kg]
double compliance(const Vector3d& point_world, const Vector3d& direction_world, const Body& body) {
  const Vector3d arm = point_world - body.com_world;
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  const Vector3d turn_body = R.transpose() * arm.cross(direction_world);
  return body.inertia.inverse_mass + turn_body.dot(body.inertia.inverse_inertia_body * turn_body);
}

Vector3d relative_velocity(const Vector3d& point_world, const Body& a, const Body& b) {
  const auto of_point = [&](const Body& body) -> Vector3d { return body.velocity_world + body.omega_world.cross(point_world - body.com_world); };
  return of_point(a) - of_point(b);
}

// Not by the law that is being judged: a record of what the impulse did.
double normal_velocity(const Contact& contact, const Body& a, const Body& b) {
  return contact.normal_b_to_a_world.dot(relative_velocity(contact.point_world, a, b));
}

// The blows that pairs have struck at one instant as one each: all they gave, from the fastest approach on. A heap hands a blow to and fro ten
// thousand times.
std::vector<Event> one_a_pair(const std::vector<Event>& events) {
  std::vector<Event> sums;
  std::map<std::pair<int, int>, std::size_t> place;
  for (const Event& event : events) {
    const auto [found, is_new] = place.try_emplace({event.body_a, event.body_b}, sums.size());
    if (is_new) {
      sums.push_back(event);
      continue;
    }
    Event& sum = sums[found->second];
    sum.impulse += event.impulse;
    sum.normal_velocity_before = std::min(sum.normal_velocity_before, event.normal_velocity_before);
    sum.normal_velocity_after = event.normal_velocity_after;
  }
  return sums;
}

double restitution_of(const World& world, const TouchingPair& pair) { return std::min(world.bodies[pair.a].restitution, world.bodies[pair.b].restitution); }
double friction_of(const World& world, const TouchingPair& pair) { return !built::kFriction ? 0.0 : std::min(world.bodies[pair.a].friction, world.bodies[pair.b].friction); }

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

  // `impulse` along the direction on A, its opposite on B.
  void push(const Laws& laws, const TouchingPair& pair, const Vector3d& point_world, const Vector3d& direction_world, double impulse) {
    for (const auto& [index, size] : {std::pair{pair.a, impulse}, std::pair{pair.b, -impulse}}) {
      Body& pushed = body(index);
      if (pushed.inertia.inverse_mass == 0.0) continue;
      if (moving.resting(index)) moving.wake(index);   // its mass was part of the impulse: it takes its share
      const Velocity after = laws.apply_impulse(pushed, size * direction_world, point_world);
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
  const double restitution = restitution_of(world, pair);
  return contact_rest_speed_ && laws_.ends_in_contact(approach_speed, restitution, *contact_rest_speed_);
}

bool SequentialImpacts::collide(Work& work, const TouchingPair& pair, double threshold) {
  Body& a = work.body(pair.a);
  Body& b = work.body(pair.b);
  const auto [approach, point_world] = fastest_approach(laws_, pair, a, b, threshold);
  if (!(approach < -threshold)) return false;
  const Contact contact = contact_of(pair, point_world);
  double restitution = restitution_of(work.moving.world(), pair);
  if (stays(work.moving.world(), pair, -approach)) restitution = 0.0;
  const double impulse = laws_.collision_impulse(contact, a, b, restitution);
  work.push(laws_, pair, contact.point_world, contact.normal_b_to_a_world, impulse);
  if (built::kFriction && contact_rest_speed_) rub(work, pair, contact, impulse);
  ++counters_.impulses;
  work.result.events.push_back({work.moving.time(), EventKind::kCollision, pair.a, pair.b, contact.point_world,
                                contact.normal_b_to_a_world, impulse, approach, normal_velocity(contact, a, b)});
  return true;
}

// Friction of an impact: against the sliding, at most what friction allows and at most what ends the sliding along its direction. It takes
// energy, never gives any: w p^2 / 2 - |slip| p <= 0 for 0 <= p <= |slip| / w.
void SequentialImpacts::rub(Work& work, const TouchingPair& pair, const Contact& contact, double impulse) {
  const double friction = friction_of(work.moving.world(), pair);
  if (!(friction > 0)) return;
  ++counters_.friction_points;
  const Vector3d relative = relative_velocity(contact.point_world, work.body(pair.a), work.body(pair.b)), &n = contact.normal_b_to_a_world;
  const Vector3d slip = relative - relative.dot(n) * n;
  const double speed = slip.norm();
  if (!(speed > 0)) return;
  const Vector3d along = slip / speed;
  const double yielding = compliance(contact.point_world, along, work.body(pair.a)) + compliance(contact.point_world, along, work.body(pair.b));
  work.push(laws_, pair, contact.point_world, along, -std::min(friction * impulse, speed / yielding));
}

// Newton's law of restitution for all pairs at once: v_n' >= -e v_n where they approach, v_n' >= 0 elsewhere, with friction.
void SequentialImpacts::collide_together(Work& work, const std::vector<TouchingPair>& pairs, double threshold, bool rebounds) {
  ContactProblem problem;
  std::map<int, int> places;
  const auto place = [&](int index) {
    const auto [found, is_new] = places.try_emplace(index, static_cast<int>(problem.bodies.size()));
    if (!is_new) return found->second;
    if (work.moving.resting(index)) work.moving.wake(index);
    const Body& body = work.body(index);
    const Matrix3d R = body.world_from_body.toRotationMatrix();
    problem.bodies.push_back({body.inertia.inverse_mass, R * body.inertia.inverse_inertia_body * R.transpose(), body.com_world, body.velocity_world, body.omega_world});
    return found->second;
  };
  struct Met {
    const TouchingPair* pair;
    double approach;
  };
  std::vector<Met> met;
  bool any = false;
  for (const TouchingPair& pair : pairs) {
    const std::size_t first = pair.points_world.size() > 1 ? 1 : 0;   // corners carry; the middle lies between them
    for (std::size_t k = first; k < pair.points_world.size(); ++k) {
      const double approach = laws_.relative_normal_velocity(contact_of(pair, pair.points_world[k]), work.body(pair.a), work.body(pair.b));
      const double restitution = !rebounds || stays(work.moving.world(), pair, -approach) ? 0.0 : restitution_of(work.moving.world(), pair);
      any = any || approach < -threshold;
      problem.contacts.push_back({place(pair.a), place(pair.b), pair.points_world[k], pair.gap.normal_b_to_a_world, friction_of(work.moving.world(), pair),
                                  approach < 0 ? -restitution * approach : 0.0, Vector3d::Zero()});
      met.push_back({&pair, approach});
    }
  }
  if (!any) return;
  const ContactSolution solution = solve_contacts(problem);
  ++counters_.contact_solves;
  for (const auto& [index, at] : places) {
    Body& body = work.body(index);
    if (body.inertia.inverse_mass == 0.0) continue;
    body.velocity_world = solution.velocities[at].linear_world;
    body.omega_world = solution.velocities[at].angular_world;
    work.changed.insert(index);
  }
  for (std::size_t i = 0; i < met.size(); ++i) {
    const TouchingPair& pair = *met[i].pair;
    const double impulse = solution.impulses_world[i].dot(pair.gap.normal_b_to_a_world);
    if (!(impulse > 0)) continue;
    ++counters_.impulses;
    const Contact contact = contact_of(pair, problem.contacts[i].point_world);
    work.result.events.push_back({work.moving.time(), EventKind::kCollision, pair.a, pair.b, contact.point_world, contact.normal_b_to_a_world, impulse, met[i].approach,
                                  normal_velocity(contact, work.body(pair.a), work.body(pair.b))});
  }
}

bool SequentialImpacts::push_pair_apart(Work& work, const TouchingPair& pair) {
  const auto [rate, point_world] = fastest_approach(laws_, pair, work.body(pair.a), work.body(pair.b), rules_.rest_speed);
  if (rate >= kFastEnough * rules_.rest_speed) return false;
  const Contact contact = contact_of(pair, point_world);
  const double yielding = compliance(contact.point_world, contact.normal_b_to_a_world, work.body(pair.a)) +
                          compliance(contact.point_world, contact.normal_b_to_a_world, work.body(pair.b));
  work.push(laws_, pair, contact.point_world, contact.normal_b_to_a_world, (rules_.rest_speed - rate) / yielding);
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

  bool again = law_ == scene::ImpactLaw::kSequential;
  int rounds = 0;
  if (!again) collide_together(work, pairs, threshold, true);
  while (again && ++rounds < (contact_rest_speed_ ? kRoundsAmongContacts : kMostRounds)) {
    again = false;
    for (const TouchingPair& pair : pairs) again = collide(work, pair, threshold) || again;
  }
  if (again && contact_rest_speed_) {   // what is left of a blow that many bodies in contact hand to and fro is taken from all at once
    collide_together(work, pairs, threshold, false);
    again = false;
    work.result.events = one_a_pair(work.result.events);
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
