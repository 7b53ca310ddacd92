/// The contact problem of an island's step: how it is set up, and which solver gets it.
#pragma once

#include <utility>
#include <vector>

#include "framework/dynamics/contact_problem.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/contact/contact_progress.h"
#include "framework/engines/contact/warm_start.h"

namespace tumble::engines {

/// Puts contacts into a problem, with the bodies on which they are that are not placed yet.
/// @param places  of bodies in the problem
void add_contacts(const MovingWorld& moving, const ContactGeometry& geometry,
                  const StepContacts& contacts, const std::vector<RigidBodyState>& states, double t,
                  BodyPlaces& places, ContactProblem& problem);

class IslandProblems {
 public:
  IslandProblems(MovingWorld& moving, const Laws& laws, const scene::ContactSpec& rules,
                 double restitution_threshold, RunCounters& counters,
                 const ContactGeometry& geometry, const WarmStart& warm_start,
                 ContactProgress& progress, ContactMemory& memory)
      : moving_(moving),
        laws_(laws),
        rules_(rules),
        restitution_threshold_(restitution_threshold),
        counters_(counters),
        geometry_(geometry),
        warm_start_(warm_start),
        progress_(progress),
        memory_(memory) {}

  /// The problem of a step of length h, which changes the velocities that the bodies would end
  /// with; with h = 0 those that they have now. With `ends`, the places that contact will leave
  /// them in: there a free body's momenta would be other velocities, and impulses change momenta.
  /// Without that, a body that spins about its slender axis gains or loses energy in proportion to
  /// the step.
  ContactProblem of(const ContactIsland& island, const StepContacts& contacts,
                    const std::vector<RigidBodyState>& states, double h,
                    const std::vector<RigidBodyState>* ends = nullptr);
  /// By the laws' contact_forces, their friction_impulses or the framework's solve_contacts.
  /// @throws StoppedRun where driven bodies leave the island no room
  ContactSolution solve(const ContactIsland& island, const ContactProblem& problem, double h);
  /// As well as the step of a large island needs it.
  ContactSolution solve_large(const ContactProblem& problem);
  /// What errors of places, and of the step, leave of velocities of points that rest on each other
  /// together. [m/s]
  double indistinct_speed(const ContactIsland& island) const;
  /// @throws StoppedRun where a solution is none
  void require_numbers(const ContactIsland& island, const ContactSolution& solution) const;

  /// What is unsolved is told once the step is committed.
  void note_unsolved(const ContactIsland& island, const ContactSolution& solution, double h);
  /// Friction goes with the load of each contact: where bodies slide, and nothing tells which of
  /// them carries it, a reader is to know.
  void say_undecided(const ContactIsland& island, const ContactSolution& solution);
  RunWatch take_unsolved() { return std::exchange(unsolved_, {}); }

 private:
  const std::vector<RigidBodyState>& middle_of_step(const ContactIsland& island,
                                                    const std::vector<RigidBodyState>* ends);
  ContactSolution solve_by_laws(const ContactIsland& island, const ContactProblem& problem,
                                double h) const;
  double speed_of_rounding(const ContactIsland& island) const;

  MovingWorld& moving_;
  const Laws& laws_;
  scene::ContactSpec rules_;
  double restitution_threshold_;  // [m/s]
  RunCounters& counters_;
  const ContactGeometry& geometry_;
  const WarmStart& warm_start_;
  ContactProgress& progress_;
  ContactMemory& memory_;
  BodyPlaces places_;                   // in the problem that is being set up
  std::vector<RigidBodyState> middle_;  // of a linked island's step, by body; others are stale
  RunWatch unsolved_;
};

}  // namespace tumble::engines
