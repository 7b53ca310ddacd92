/// Steps of large islands: many bodies without restitution, solved in steps and not at instants.
///
/// One impact changes dozens of others in the same instant, so nothing is gained by locating any of
/// them. A large island goes
///   x' = x + h v',   q' = q turned by h omega'
/// with the velocities v' that solve the contact problem at the middle of the step, where surfaces
/// are met evenly (Moreau's midpoint); contacts that would be passed by then are met at the start.
/// The answer is good to a hundred-thousandth of the island's speed; a margin of that size around
/// each body takes up the error, so that gaps stay open.
/// Source: J. J. Moreau, "Numerical aspects of the sweeping process", 1999.
#pragma once

#include <vector>

#include "framework/engines/contact/contact_reach.h"
#include "framework/engines/contact/island_problems.h"

namespace tumble::engines {

class LargeIslands {
 public:
  LargeIslands(MovingWorld& moving, const scene::ContactSpec& rules, double restitution_threshold,
               RunCounters& counters, const ContactGeometry& geometry, const ContactReach& reach,
               IslandProblems& problems, ContactMemory& memory)
      : moving_(moving),
        rules_(rules),
        restitution_threshold_(restitution_threshold),
        counters_(counters),
        geometry_(geometry),
        reach_(reach),
        problems_(problems),
        memory_(memory) {}

  bool is_large(const ContactIsland& island) const;
  /// An impact is about to cut the step for this island. Too many of them, and it is solved in
  /// steps from now on, until it rests or separates.
  bool becomes_large(const ContactIsland& island);

  struct Step {
    StepContacts contacts;
    ContactProblem problem;
    ContactSolution solution;
  };
  /// The island's contacts at the middle of the step, and their impulses.
  Step solve(const ContactIsland& island, double h);

 private:
  bool locates() const { return rules_.plastic_impacts != scene::PlasticImpacts::kInStep; }
  void report();
  std::vector<RigidBodyState> middle_of(const ContactIsland& island, double h) const;
  StepContacts contacts_of(const ContactIsland& island, const std::vector<RigidBodyState>& middle,
                           double h);

  MovingWorld& moving_;
  scene::ContactSpec rules_;
  double restitution_threshold_;  // [m/s]
  RunCounters& counters_;
  const ContactGeometry& geometry_;
  const ContactReach& reach_;
  IslandProblems& problems_;
  ContactMemory& memory_;
};

}  // namespace tumble::engines
