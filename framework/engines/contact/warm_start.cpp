#include "framework/engines/contact/warm_start.h"

#include <algorithm>

namespace tumble::engines {

// What an earlier attempt at this step has found for the pair, or else the last step.
const std::vector<KnownImpulse>* WarmStart::known(Pair pair) const {
  const auto tried = memory_.tried_impulses.find(pair);
  return tried != memory_.tried_impulses.end() ? &tried->second : memory_.last_impulses.find(pair);
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

// @param impulses_of  (pair): where its impulses go
template <class ImpulsesOf>
void WarmStart::store(const StepContacts& contacts, const ContactProblem& problem,
                      const ContactSolution& solution, double h,
                      const ImpulsesOf& impulses_of) const {
  for (std::size_t from = 0, to = 0; from < contacts.size(); from = to) {
    const Pair& pair = contacts[from].pair;
    while (to < contacts.size() && contacts[to].pair == pair) ++to;
    std::vector<KnownImpulse>& known = impulses_of(pair);
    known.clear();
    known.reserve(to - from);
    const RigidBodyState& a = moving_.state(pair.first);
    for (std::size_t i = from; i < to; ++i)
      known.push_back(
          {a.world_from_body.conjugate() * (problem.contacts[i].point_world - a.com_world),
           solution.impulses_world[i], h});
  }
}

void WarmStart::remember_attempt(const StepContacts& contacts, const ContactProblem& problem,
                                 const ContactSolution& solution, double h) {
  store(
      contacts, problem, solution,
      h, [&](const Pair& pair) -> auto& { return memory_.tried_impulses[pair]; });
}

void WarmStart::remember(const StepContacts& contacts, const ContactProblem& problem,
                         const ContactSolution& solution, double h) {
  store(
      contacts, problem, solution, h, [&](const Pair& pair) -> auto& {
        return next_.emplace_back(pair, std::vector<KnownImpulse>{}).second;
      });
}

void WarmStart::end_step() {
  std::sort(next_.begin(), next_.end(),
            [](const auto& one, const auto& other) { return one.first < other.first; });
  memory_.last_impulses.clear();
  for (auto& [pair, impulses] : next_) memory_.last_impulses.enter(pair, std::move(impulses));
  next_.clear();
  memory_.tried_impulses.clear();
}

}  // namespace tumble::engines
