#include "framework/engines/contact/sliding_stop.h"

#include <algorithm>
#include <utility>

#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"

namespace tumble::engines {

std::optional<double> SlidingStop::of(const ContactProblem& problem, const StepContacts& contacts,
                                      const ContactSolution& solution, double h) {
  constexpr double kTurnsBack = 0.99;  // cosine: against the way that it slid, but for turning
  if (contacts.size() > kContact.few_contacts) return std::nullopt;
  const std::pair<int, int>* stopping = nullptr;
  double least = 1.0, stopping_impulse = 0.0, available = 0.0;
  double turns_back = 1.0;  // of the step: where the first pair does
  for (std::size_t i = 0; i < contacts.size();) {
    const auto& pair = contacts[i].pair;
    Vector3d along = Vector3d::Zero();
    Vector3d slips = Vector3d::Zero(), slips_at_end = Vector3d::Zero();  // of the fastest point
    double limit = 0.0, slip = 0.0, speed = 0.0;
    bool sticks = true;
    for (; i < contacts.size() && contacts[i].pair == pair; ++i) {
      const PushingContact& c = problem.contacts[i];
      const Vector3d& n = c.normal_b_to_a_world;
      const auto velocity = [&](int body) -> Vector3d {
        const Body b = moving_.body_at_impact(body);
        const Vector3d arm = geometry_.point_of(pair, contacts[i].point) - b.com_world;
        if (!moving_.world().bodies[body].immovable())
          speed = std::max(speed, b.velocity_world.norm() + b.omega_world.norm() * arm.norm());
        return b.velocity_world + b.omega_world.cross(arm);
      };
      // at the step's start, where it touched then
      const Vector3d va = velocity(pair.first), vb = velocity(pair.second), relative = va - vb;
      if (const Vector3d slides = relative - relative.dot(n) * n; slides.norm() > slip) {
        slips = slides;
        slip = slides.norm();
        const Vector3d end =
            relative_velocity(problem, i, solution.velocities) - c.slip_target_world;
        slips_at_end = end - end.dot(n) * n;
      }
      speed = std::max({speed, va.norm(), vb.norm()});
      const double normal = solution.impulses_world[i].dot(n);
      along += solution.impulses_world[i] - normal * n;
      limit += c.friction * normal;
      // Points share what stops a pair: one may give all that it can, and others not.
      sticks = sticks &&
               (solution.modes[i] == ContactMode::kStick ||
                (solution.modes[i] == ContactMode::kOpen && normal == 0.0) ||
                (solution.modes[i] == ContactMode::kSlide &&
                 slip_speed(problem, i, solution.velocities) <= kCreep * restitution_threshold_));
    }
    // What friction stops within a billionth of the step has stopped.
    const double within_step = limit * (moving_.world().bodies[pair.first].inertia.inverse_mass +
                                        moving_.world().bodies[pair.second].inertia.inverse_mass);
    if (memory_.stuck.contains(pair) || !(limit > 0) || slip <= kNegligible * (speed + within_step))
      continue;
    // With the friction that brakes it, it would end by twice what friction gives more slowly.
    if (const double back = -slips_at_end.dot(slips) / slip;
        !sticks && back > kTurnsBack * slips_at_end.norm())
      turns_back = std::min(turns_back, slip / (slip + back + 2 * within_step));
    if (!sticks) continue;
    if (along.norm() >= least * limit) continue;
    least = along.norm() / limit;
    stopping = &pair;
    // signed: on a slope gravity may do more than stop it, and friction holds it then
    stopping_impulse = -along.dot(slips) / slip;
    available = limit;
  }
  if (!stopping && turns_back == 1.0) return std::nullopt;
  if (!(moving_.time() < memory_.searched_from + memory_.longest_step)) {
    memory_.searched_from = moving_.time();
    memory_.searches = 0;
  }
  if (++memory_.searches > kContact.most_searches) return std::nullopt;
  if (!stopping) {
    if (h <= kContact.shortest_step * memory_.longest_step) return std::nullopt;
    return moving_.time() + h * std::max(turns_back, kContact.soon);
  }
  if (memory_.sliding_search && memory_.sliding_search->pair == *stopping &&
      memory_.sliding_search->start == moving_.time()) {
    if (memory_.sliding_search->found) return std::nullopt;
    const double F = (memory_.sliding_search->impulse - stopping_impulse) /
                     (memory_.sliding_search->duration - h),
                 A = stopping_impulse - F * h, M = available / h;
    const double stop = A / (M - F);
    if (!(stop > kContact.shortest_step * memory_.longest_step) ||
        !(stop < memory_.sliding_search->duration))
      return std::nullopt;
    memory_.sliding_search->found = true;
    return moving_.time() + stop;
  }
  if (least >= 1 - kSolverResidue || h <= kContact.shortest_step * memory_.longest_step)
    return std::nullopt;
  memory_.sliding_search = SlidingSearch{*stopping, moving_.time(), h, stopping_impulse, false};
  return moving_.time() + h * std::max(least, kContact.soon);
}

}  // namespace tumble::engines
