/// Where sliding ends within a step.
#pragma once

#include <optional>

#include "framework/engines/contact/contact_geometry.h"
#include "framework/engines/contact/contact_memory.h"
#include "framework/engines/contact/step_contact.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

class SlidingStop {
 public:
  SlidingStop(const MovingWorld& moving, const ContactGeometry& geometry,
              double restitution_threshold, ContactMemory& memory)
      : moving_(moving),
        geometry_(geometry),
        restitution_threshold_(restitution_threshold),
        memory_(memory) {}

  /// Where a pair that slid and would stick at the end of the step stops sliding: when the friction
  /// that stops it is all there can be. What stops the slip is A + F s, with F the steady forces
  /// along it, the available friction M s; two steps of different lengths tell A and F. A pair that
  /// slides back at the end of the step has stopped within it, too: there its friction turns round.
  /// @return a target to begin the step again with; nothing: no sliding ends in it
  std::optional<double> of(const ContactProblem& problem, const StepContacts& contacts,
                           const ContactSolution& solution, double h);

 private:
  const MovingWorld& moving_;
  const ContactGeometry& geometry_;
  double restitution_threshold_;  // [m/s]
  ContactMemory& memory_;
};

}  // namespace tumble::engines
