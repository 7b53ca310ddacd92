// Whether contacts have brought energy in. Part of PersistentContacts.
//
// What touches and does not rebound only ever takes energy away: friction does, and impacts without
// rebound. An island that carries more than the forces of the step can hold in balance (a heavy
// slab on a small ball, a box on the crest of another) topples faster than its step follows: the
// impulses of the step's middle, found where the bodies would be without toppling, push along what
// has turned away since, and do work.
#include <algorithm>

#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/persistent_contacts.h"

namespace tumble::engines {

// Between the ends of the paths that its bodies have been given. Not asked of what springs, motors
// or driven supports may give energy to.
bool PersistentContacts::gains_energy(const ContactIsland& island) {
  if (!island.linked.empty()) return false;
  for (const Pair& pair : island.pairs)
    if (moving_.is_driven(pair.first) || moving_.is_driven(pair.second)) return false;
  const World& world = moving_.world();
  const Vector3d gravity = world.gravity_world.value_or(Vector3d::Zero());
  double gain = 0.0, moves_before = 0.0, moves_after = 0.0, unseen = 0.0, terms = 0.0;  // [J]
  for (const int index : island.bodies) {
    const WorldBody& body = world.bodies[static_cast<std::size_t>(index)];
    const RigidBodyState &start = moving_.state(index), &end = moving_.path_end(index);
    const double mass = body.inertia.mass;
    moves_before += kinetic_energy(start, body.inertia);
    moves_after += kinetic_energy(end, body.inertia);
    gain -= moving_.steady_work(index, start, end);
    terms += mass * gravity.cwiseAbs().dot(start.com_world.cwiseAbs());
    unseen += mass * (restitution_threshold_ * restitution_threshold_ +
                      kSixDigits * gravity.norm() * moving_.shape(index).bounding_radius());
  }
  gain += moves_after - moves_before;
  return gain > kEnergyRises * std::max(moves_before, moves_after) + unseen +
                    kDeviations * kEpsilon * terms;
}

}  // namespace tumble::engines
