// Points that come down within a step: when they do, and the blow they strike. Part of LastingContacts.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/impact_bodies.h"
#include "framework/engines/contact/lasting_contacts.h"

namespace tumble::engines {

// Of A against B at a contact, with these velocities of theirs. [m/s]
Vector3d LastingContacts::relative_velocity(const ContactProblem& problem, std::size_t contact, const std::vector<Velocity>& velocities) {
  const PushingContact& c = problem.contacts[contact];
  const auto velocity = [&](int body) -> Vector3d {
    return velocities[body].linear_world + velocities[body].angular_world.cross(c.point_world - problem.bodies[body].com_world);
  };
  return velocity(c.body_a) - velocity(c.body_b);
}

// How fast the two come together there. [m/s], > 0 approaching
double LastingContacts::approach(const ContactProblem& problem, std::size_t contact, const std::vector<Velocity>& velocities) {
  return -problem.contacts[contact].normal_b_to_a_world.dot(relative_velocity(problem, contact, velocities));
}

double LastingContacts::slip_speed(const ContactProblem& problem, std::size_t contact, const std::vector<Velocity>& velocities) {
  const PushingContact& c = problem.contacts[contact];
  const Vector3d relative = relative_velocity(problem, contact, velocities) - c.slip_target_world;
  return (relative - relative.dot(c.normal_b_to_a_world) * c.normal_b_to_a_world).norm();
}

bool LastingContacts::is_down(const StepContact& touch) const {
  const double thickness = geometry_.margin(touch.pair);
  return touch.point.gap - thickness <= thickness + kContact.down * rest_speed_ * memory_.longest_step;
}

// At the step's start; the problem's own are those of its end, of driven bodies too.
std::vector<Velocity> LastingContacts::velocities_now(const ContactIsland& island, const std::vector<StepContact>& touches, const ContactProblem& problem) const {
  std::vector<Velocity> now = velocities_of(problem);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {   // the problem's first bodies are the island's
    const Body body = moving_.body_at_impact(island.bodies[k]);
    now[k] = {body.velocity_world, body.omega_world};
  }
  const auto set_driven = [&](int body, int place) {
    if (moving_.is_driven(body)) now[static_cast<std::size_t>(place)].linear_world = prescribed_velocity(moving_.world().bodies[static_cast<std::size_t>(body)], moving_.time());
  };
  for (std::size_t i = 0; i < touches.size(); ++i) {
    set_driven(touches[i].pair.first, problem.contacts[i].body_a);
    set_driven(touches[i].pair.second, problem.contacts[i].body_b);
  }
  return now;
}

// Points that touch and part at the step's start, more slowly than they could leave in it: they hop, and have come down again by its end,
//   gap(h) = h (v0 + v1) / 2 = 0,  so that  v1 = -v0.
// Without that they would end at rest where half of their first velocity has taken them: an edge that rocks would be lifted by
// v0 h / 2 each time, which is more energy than it has wherever v0 < g h. @return whether there are any
bool LastingContacts::let_part(const ContactIsland& island, std::vector<StepContact>& touches, ContactProblem& problem) const {
  if (!island.linked.empty()) return false;   // what hangs on links is not lifted by itself: their reactions are part of what parts it
  const std::vector<Velocity> now = velocities_now(island, touches, problem);
  bool any = false;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const double parting = -approach(problem, i, now);
    if (touches[i].lands || !(parting > kContact.hop * rest_speed_)) continue;
    touches[i].target = problem.contacts[i].target = -parting;
    any = true;
  }
  return any;
}

void LastingContacts::keep_together(std::vector<StepContact>& touches, ContactProblem& problem) {
  for (std::size_t i = 0; i < touches.size(); ++i)
    if (!touches[i].lands) touches[i].target = problem.contacts[i].target = 0.0;
}

// Does a point that is apart press, or would its path be under the surface, with this answer?
bool LastingContacts::comes_down(const ContactIsland& island, const std::vector<StepContact>& touches, const ContactProblem& problem, const ContactSolution& solution, double h) const {
  const std::vector<Velocity> now = velocities_now(island, touches, problem);
  for (std::size_t i = 0; i < touches.size(); ++i) {
    if (!touches[i].lands) continue;
    const double way = 0.5 * h * (approach(problem, i, now) + approach(problem, i, solution.velocities));
    if (solution.impulses_world[i].squaredNorm() > 0.0 || way > touches[i].point.gap - geometry_.margin(touches[i].pair)) return true;
  }
  return false;
}

// When points that are apart come down where nothing holds them up, from the velocities at the step's ends:
//   gap(t) = r + v0 t + (v1 - v0) t^2 / (2 h).
std::vector<LastingContacts::Landing> LastingContacts::predict_landings(const ContactIsland& island, const std::vector<StepContact>& touches, double h) {
  std::vector<StepContact> held;
  std::copy_if(touches.begin(), touches.end(), std::back_inserter(held), [](const StepContact& touch) { return !touch.lands; });
  const ContactProblem problem = problem_of(island, touches, moving_.states(), h);
  const std::vector<Velocity> now = velocities_now(island, touches, problem);
  std::vector<Velocity> then = velocities_of(problem);
  if (!held.empty() || !problem.rows.empty()) {
    const ContactSolution free = solve(island, problem_of(island, held, moving_.states(), h), h);
    std::copy_n(free.velocities.begin(), island.bodies.size(), then.begin());
  }
  std::vector<Landing> landings;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    if (!touches[i].lands) continue;
    const double room = touches[i].point.gap - geometry_.margin(touches[i].pair);
    const double v0 = approach(problem, i, now), v1 = approach(problem, i, then), bend = (v1 - v0) / h;
    const double square = v0 * v0 + 2 * bend * room, speed = std::sqrt(std::max(0.0, square));
    const bool comes = square >= 0 && v0 + speed > 0;
    const double t = comes ? 2 * room / (v0 + speed) : h;   // the smaller root, in the form that does not cancel
    landings.push_back({i, t, speed, v0, comes && t <= h});
  }
  return landings;
}

// Points that are apart at the step's start: where one comes down faster than the rest speed the step ends; slower ones stay, with the
// velocity at the end that takes them down by then; others must not come farther.
// @return an earlier target (or the same after a blow) to begin the step again with
std::optional<double> LastingContacts::sort_out_landings(const ContactIsland& island, std::vector<StepContact>& touches, double h) {
  const std::vector<Landing> landings = predict_landings(island, touches, h);
  std::vector<bool> stays(touches.size(), true);
  double first = h;
  for (const Landing& landing : landings)
    if (landing.within && landing.speed > rest_speed_) first = std::min(first, landing.time);
  const double end = first <= kContact.soon * memory_.longest_step ? first : kContact.before_landing * first;
  if (first < h && end < (1 - kContact.at_end) * h && h > kContact.shortest_step * kContact.soon * memory_.longest_step) return moving_.time() + end;
  std::vector<StepContact> blows;
  for (const Landing& landing : landings) {
    StepContact& touch = touches[landing.touch];
    stays[landing.touch] = !(landing.within && landing.speed > rest_speed_);
    const double steady = 2 * (touch.point.gap - geometry_.margin(touch.pair)) / h;   // from this speed evenly to none it comes down at the step's end
    touch.lands = false;
    touch.target = std::min(0.0, landing.approach - steady);
    if (landing.within && stays[landing.touch] && landing.approach > steady) blows.push_back({touch.pair, touch.point, -steady, false});
  }
  if (!blows.empty()) {
    for (const StepContact& touch : touches)
      if (is_down(touch)) blows.push_back({touch.pair, touch.point, 0.0, false});
    if (strike(island, std::move(blows))) return moving_.target();
  }
  std::size_t i = 0;
  std::erase_if(touches, [&](const StepContact&) { return !stays[i++]; });
  return std::nullopt;
}

// Points that touch and come together: their velocities jump. @return whether any did
bool LastingContacts::strike_what_is_down(const ContactIsland& island, const std::vector<StepContact>& touches) {
  if (std::none_of(touches.begin(), touches.end(), [&](const StepContact& touch) { return is_down(touch); })) return false;
  // Corners of an edge that comes down flat strike together, though rounding takes one of them down first.
  std::vector<StepContact> down;
  for (const StepContact& touch : touches) {
    const double size = geometry_.size_of(touch.pair);
    if (is_down(touch) || touch.point.gap < kContact.together * size) down.push_back({touch.pair, touch.point, 0.0, false});
  }
  return strike(island, std::move(down));
}

std::vector<int> LastingContacts::touched_bodies(const ContactIsland& island, const std::vector<StepContact>& touches) {
  std::vector<int> bodies = island.bodies;
  for (const StepContact& touch : touches) {
    bodies.push_back(touch.pair.first);
    bodies.push_back(touch.pair.second);
  }
  return bodies;
}

bool LastingContacts::strike(const ContactIsland& island, std::vector<StepContact> down) {
  std::stable_sort(down.begin(), down.end(), [](const StepContact& a, const StepContact& b) { return a.pair < b.pair; });
  const ContactProblem problem = problem_of(island, down, moving_.states(), 0.0);
  const std::vector<Velocity> before = velocities_of(problem);
  // What goes less than a shell in a step is left to the step's impulses.
  const bool any = [&] {
    for (std::size_t i = 0; i < down.size(); ++i)
      if ((is_down(down[i]) || down[i].target < 0) && approach(problem, i, before) + down[i].target > std::max(kContact.impact * rest_speed_, geometry_.margin(down[i].pair) / memory_.longest_step)) return true;
    return false;
  }();
  if (!any) return false;
  if (memory_.landed_at != moving_.time()) memory_.landed_there = 0;
  memory_.landed_at = moving_.time();
  if (++memory_.landed_there > kContact.most_impacts_at_once) return false;
  const ContactSolution solution = solve(island, problem, 1.0);
  note_unsolved(island, solution, memory_.longest_step);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    const Inertia& inertia = moving_.world().bodies[body].inertia;
    RigidBodyState state = moving_.state(body);
    state.momentum_world = inertia.mass * solution.velocities[k].linear_world;
    state.angular_momentum_world = angular_momentum_of(solution.velocities[k].angular_world, state.world_from_body, inertia);
    moving_.set_state(body, state);
  }
  ++counters_.contact_landings;
  // The energy of all, which the first event stands for; not told where links end in, or bodies touch, what is driven in different ways.
  const Vector3d driven = ImpactBodies(moving_, laws_).driven_velocity(touched_bodies(island, down)).value_or(Vector3d::Constant(kUnset));
  EnergyOfImpact energy;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const WorldBody& body = moving_.world().bodies[static_cast<std::size_t>(island.bodies[k])];
    energy.add(body.inertia, moving_.state(island.bodies[k]).world_from_body, before[k], solution.velocities[k], driven);
  }
  double excess = energy.excess(solution.converged ? work_of(problem, solution.impulses_world, before, solution.velocities) : energy.change);   // unsolved: never more is all that can be asked
  for (std::size_t from = 0, to = 0; from < down.size(); from = to) {   // a pair's hardest blow stands for it
    std::size_t hardest = from;
    for (; to < down.size() && down[to].pair == down[from].pair; ++to)
      if (solution.impulses_world[to].squaredNorm() > solution.impulses_world[hardest].squaredNorm()) hardest = to;
    const double speed = approach(problem, hardest, before);
    if (!(speed > rest_speed_)) continue;
    const PushingContact& c = problem.contacts[hardest];
    sink_.event({moving_.time(), EventKind::kCollision, down[hardest].pair.first, down[hardest].pair.second, c.point_world, c.normal_b_to_a_world,
                 solution.impulses_world[hardest].dot(c.normal_b_to_a_world), -speed, -approach(problem, hardest, solution.velocities), energy.change, excess});
    energy.change = excess = 0.0;
  }
  return true;
}

}  // namespace tumble::engines
