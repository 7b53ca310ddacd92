/// Impulses that an earlier problem of a pair had: the next one begins with them.
#pragma once

#include <utility>
#include <vector>

#include "framework/engines/contact/contact_geometry.h"
#include "framework/engines/contact/contact_memory.h"
#include "framework/engines/contact/step_contact.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

class WarmStart {
 public:
  using Pair = ContactGeometry::Pair;  // bodies, first < second

  WarmStart(const MovingWorld& moving, const ContactGeometry& geometry, ContactMemory& memory)
      : moving_(moving), geometry_(geometry), memory_(memory) {}

  /// Each impulse that is known goes to the point that is nearest to where it acted.
  /// @param states    that the contacts are looked at in
  /// @param farthest  from there, of the bodies' size
  void set(const StepContacts& contacts, const std::vector<RigidBodyState>& states, double h,
           double farthest, ContactProblem& problem) const;

  /// A step begins; attempts at it remember.
  void begin_step() { next_.clear(); }
  /// An attempt at the step has found this: the next attempt begins with it.
  void remember_attempt(const StepContacts& contacts, const ContactProblem& problem,
                        const ContactSolution& solution, double h);
  /// This is what an island's step comes out with.
  void remember(const StepContacts& contacts, const ContactProblem& problem,
                const ContactSolution& solution, double h);
  /// All islands have their step: the next one begins with what they remember.
  void end_step();

 private:
  const std::vector<KnownImpulse>* known(Pair pair) const;
  template <class ImpulsesOf>
  void store(const StepContacts& contacts, const ContactProblem& problem,
             const ContactSolution& solution, double h, const ImpulsesOf& impulses_of) const;

  const MovingWorld& moving_;
  const ContactGeometry& geometry_;
  ContactMemory& memory_;
  std::vector<std::pair<Pair, std::vector<KnownImpulse>>> next_;  // island by island
};

}  // namespace tumble::engines
