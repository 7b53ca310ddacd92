#include "framework/engines/contact/warm_start.h"

#include <algorithm>

namespace tumble::engines {

// What an earlier attempt at this step has found for the pair, or else the last step.
const std::vector<KnownImpulse>* WarmStart::known(Pair pair) const {
  for (const auto* store : {&memory_.tried_impulses, &memory_.last_impulses})
    if (const auto known = store->find(pair); known != store->end()) return &known->second;
  return nullptr;
}

void WarmStart::set(const StepContacts& contacts, const std::vector<RigidBodyState>& states,
                    double h, double farthest, ContactProblem& problem) const {
  for (std::size_t from = 0, to = 0; from < contacts.size(); from = to) {
    const Pair& pair = contacts[from].pair;
    while (to < contacts.size() && contacts[to].pair == pair) ++to;
    const std::vector<KnownImpulse>* const warm = known(pair);
    if (!warm) continue;
    const RigidBodyState& a = states[pair.first];
    const double size = geometry_.size_of(pair);
    for (const KnownImpulse& known : *warm) {
      const Vector3d acted = a.com_world + a.world_from_body * known.point_body_a;
      PushingContact* nearest = nullptr;
      double least = farthest * size;
      for (std::size_t i = from; i < to; ++i) {
        const double distance = (problem.contacts[i].point_world - acted).norm();
        if (distance >= least) continue;
        least = distance;
        nearest = &problem.contacts[i];
      }
      // A longer step needs more where the force lasts, no more where it was an impact.
      if (nearest)
        nearest->warm_start_world += std::min(1.0, h / known.duration) * known.impulse_world;
    }
  }
}

void WarmStart::store(const StepContacts& contacts, const ContactProblem& problem,
                      const ContactSolution& solution, double h, Impulses& impulses) const {
  for (std::size_t from = 0, to = 0; from < contacts.size(); from = to) {
    const Pair& pair = contacts[from].pair;
    while (to < contacts.size() && contacts[to].pair == pair) ++to;
    std::vector<KnownImpulse>& known = impulses[pair];
    known.clear();
    known.reserve(to - from);
    const RigidBodyState& a = moving_.state(pair.first);
    for (std::size_t i = from; i < to; ++i)
      known.push_back(
          {a.world_from_body.conjugate() * (problem.contacts[i].point_world - a.com_world),
           solution.impulses_world[i], h});
  }
}

}  // namespace tumble::engines
