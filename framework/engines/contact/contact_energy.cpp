// What contacts have brought in of energy, or taken. Part of PersistentContacts.
//
// What touches and does not rebound only ever takes energy away: friction does, and impacts without
// rebound. An island that carries more than the forces of the step can hold in balance (a heavy
// slab on a small ball, a box on the crest of another) topples faster than its step follows: the
// impulses of the step's middle, found where the bodies would be without toppling, push along what
// has turned away since, and do work.
//
// Where a body rolls or rests, contacts take nothing; where it slides, friction takes the impulse
// times the way; where it lands, the impulse takes what came together. With E the energy of what
// touches, g what gravity and point forces do, p_n and p_t the impulses of a step, u the speed at
// which the two approach when it begins, s the speed at which they slide at its ends:
//   lost = E(0) - E(h) + g - sum (p_n u + |p_t| max(s(0), s(h)))                         (1)
// is above 0 by the error of the step alone.
#include <algorithm>
#include <optional>

#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/persistent_contacts.h"

namespace tumble::engines {

// Between the ends of the paths that its bodies have been given. Not asked of what springs, motors
// or driven supports may give energy to.
std::optional<PersistentContacts::StepEnergy> PersistentContacts::energy_of(
    const ContactIsland& island) const {
  if (!island.linked.empty()) return std::nullopt;
  for (const Pair& pair : island.pairs)
    if (moving_.is_driven(pair.first) || moving_.is_driven(pair.second)) return std::nullopt;
  const World& world = moving_.world();
  const Vector3d gravity = world.gravity_world.value_or(Vector3d::Zero());
  StepEnergy energy;
  double moves_before = 0.0, moves_after = 0.0, unseen = 0.0, terms = 0.0;  // [J]
  for (const int index : island.bodies) {
    const WorldBody& body = world.bodies[static_cast<std::size_t>(index)];
    const RigidBodyState &start = moving_.state(index), &end = moving_.path_end(index);
    const double mass = body.inertia.mass;
    moves_before += kinetic_energy(start, body.inertia);
    moves_after += kinetic_energy(end, body.inertia);
    energy.gain -= moving_.steady_work(index, start, end);
    terms += mass * gravity.cwiseAbs().dot(start.com_world.cwiseAbs());
    unseen += mass * (restitution_threshold_ * restitution_threshold_ +
                      kSixDigits * gravity.norm() * moving_.shape(index).bounding_radius());
  }
  energy.gain += moves_after - moves_before;
  energy.unseen =
      kEnergyRises * std::max(moves_before, moves_after) + unseen + kDeviations * kEpsilon * terms;
  return energy;
}

// Eq. (1), to count once the step is committed.
// @param starts  the contacts where the step begins; the problem's are the same, farther on
void PersistentContacts::note_loss(const ContactIsland& island, const StepContacts& starts,
                                   const ContactProblem& problem, const ContactSolution& solution,
                                   const StepEnergy& energy) {
  double taken = 0.0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Vector3d& impulse = solution.impulses_world[i];
    if (impulse.isZero(0.0)) continue;
    const Pair& pair = starts[i].pair;
    const Vector3d &n = starts[i].point.normal_b_to_a_world,
                   &n_then = problem.contacts[i].normal_b_to_a_world;
    const Vector3d point = geometry_.point_of(pair, starts[i].point);
    const auto velocity = [&](int body) -> Vector3d {
      const WorldBody& b = moving_.world().bodies[static_cast<std::size_t>(body)];
      if (b.immovable()) return Vector3d::Zero();
      const RigidBodyState& state = moving_.state(body);
      return b.inertia.inverse_mass * state.momentum_world +
             omega_of(state, b.inertia).cross(point - state.com_world);
    };
    const Vector3d coming = velocity(pair.first) - velocity(pair.second);
    const double approach = std::max(0.0, -n.dot(coming)), pressed = n_then.dot(impulse);
    taken += pressed * approach;
    const bool rolls = solution.modes[i] == ContactMode::kStick && !starts[i].activates &&
                       memory_.stuck.contains(pair);
    if (rolls) continue;
    taken +=
        (impulse - pressed * n_then).norm() *
        std::max((coming - n.dot(coming) * n).norm(), slip_speed(problem, i, solution.velocities));
  }
  lost_.push_back({static_cast<std::size_t>(&island - islands_.data()), -energy.gain - taken});
}

}  // namespace tumble::engines
