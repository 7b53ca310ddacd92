/// Contacts that become active within a step: when their gaps close, and the impact there.
#pragma once

#include <optional>
#include <vector>

#include "framework/engines/contact/island_problems.h"

namespace tumble::engines {

class ContactActivation {
 public:
  ContactActivation(MovingWorld& moving, const Laws& laws, double restitution_threshold,
                    RunCounters& counters, TrajectorySink& sink, const ContactGeometry& geometry,
                    IslandProblems& problems, ContactMemory& memory)
      : moving_(moving),
        laws_(laws),
        restitution_threshold_(restitution_threshold),
        counters_(counters),
        sink_(sink),
        geometry_(geometry),
        problems_(problems),
        memory_(memory) {}

  /// Points that touch and come together: their velocities jump.
  /// @return whether any did
  bool apply_impacts_of_active(const ContactIsland& island, const StepContacts& contacts);
  /// Points that touch and separate at the step's start, more slowly than they could leave in it:
  /// their gap closes again by its end,
  ///   gap(h) = h (v0 + v1) / 2 = 0,  so that  v1 = -v0.
  /// Without that they would end at rest where half of their first velocity has taken them: an edge
  /// that rocks would be lifted by v0 h / 2 each time, which is more energy than it has wherever
  /// v0 < g h.
  /// @return whether there are any
  bool allow_separation(const ContactIsland& island, StepContacts& contacts,
                        ContactProblem& problem) const;
  /// Whether a point that is apart presses, or its path would be under the surface, with this
  /// answer.
  bool is_activated(const ContactIsland& island, const StepContacts& contacts,
                    const ContactProblem& problem, const ContactSolution& solution, double h) const;
  /// Points that are apart at the step's start: where one closes its gap faster than the
  /// restitution threshold the step ends; slower ones stay, with the velocity at the end that
  /// closes the gap by then; others must not come nearer than that.
  /// @return an earlier target (or the same after an impact) to begin the step again with
  std::optional<double> handle(const ContactIsland& island, StepContacts& contacts, double h);

 private:
  struct Activation {
    std::size_t step_contact;  // which
    double time, speed;        // since the step's start [s], with which it comes down [m/s]
    double approach;           // at the step's start [m/s]
    bool within;               // the step
  };

  bool is_active(const StepContact& step_contact) const;
  std::vector<Velocity> velocities_now(const ContactIsland& island, const StepContacts& contacts,
                                       const ContactProblem& problem) const;
  std::vector<Activation> predict(const ContactIsland& island, const StepContacts& contacts,
                                  double h);
  bool apply_impact(const ContactIsland& island, StepContacts down);

  MovingWorld& moving_;
  const Laws& laws_;
  double restitution_threshold_;  // [m/s]
  RunCounters& counters_;
  TrajectorySink& sink_;
  const ContactGeometry& geometry_;
  IslandProblems& problems_;
  ContactMemory& memory_;
};

}  // namespace tumble::engines
