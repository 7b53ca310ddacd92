/// What contacts press bodies with, of those on which forces act that follow their motion: springs,
/// drag and water are integrated with it, or they would feel a body that falls.
#pragma once

#include <map>
#include <vector>

#include "framework/engines/contact/contact_memory.h"
#include "framework/engines/contact/step_contact.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

class PressedBodies {
 public:
  PressedBodies(MovingWorld& moving, const ContactMemory& memory)
      : moving_(moving), memory_(memory) {}

  /// Leads the bodies of these islands by what pressed them in the last step, as long as they touch
  /// anything.
  void begin_step(const std::vector<ContactIsland>& islands);
  /// What contacts press the island's bodies with, its mean over the step: for the next step. Where
  /// these bodies were not pressed in the step before, they are led anew by what has been found,
  /// until it stays the same.
  /// @param ends  states that the problem took the inertia of the bodies from; null: from the ends
  /// of their free paths
  /// @return whether they have been: the step is taken again
  bool finds_other(const ContactIsland& island, const StepContacts& contacts,
                   const ContactProblem& problem, const ContactSolution& solution, double h,
                   const std::vector<RigidBodyState>* ends);
  /// By body, for the next step.
  std::map<int, Wrench> take_next() { return std::exchange(next_, {}); }

 private:
  std::map<int, Wrench> changes_from_felt(const std::map<int, Wrench>& found) const;
  std::map<int, Wrench> limit_of(int first, const std::map<int, Wrench>& found);

  MovingWorld& moving_;
  const ContactMemory& memory_;
  std::map<int, Wrench> felt_;  // by body: what it was led with (MovingWorld::lead_pressed)
  std::map<int, Wrench> next_;
  std::map<int, int> rounds_;  // how often that was looked for, by an island's first body
  // by an island's first body, of its bodies: how far the last round was from what they were led
  // with; empty: not known
  std::map<int, std::map<int, Wrench>> changes_;
};

}  // namespace tumble::engines
