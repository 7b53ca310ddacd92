/// Position correction: removes the overlaps that rotation, rounding and errors of solvers leave.
///
/// The correction is minimal in the kinetic (mass) metric, with mass ratios above 1e4 taken as 1e4;
/// no rod or joint opens, and velocities stay. It begins where a gap is below half its margin (in
/// large islands a tenth) and takes it to the margin. Gaps are a linear complementarity problem,
/// rows are equalities: the contact solver answers both, of large islands by a few sweeps. Where
/// rods, joints or walls leave no room for the margin (a bar that touches a wall at its own hinge),
/// that pair only must not overlap.
#pragma once

#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "framework/engines/contact/contact_geometry.h"
#include "framework/engines/contact/contact_island.h"
#include "framework/engines/contact/contact_memory.h"

namespace tumble::engines {

/// A contact point that pushes to the step's end: it is drawn to its margin, too.
struct ActiveContact {
  std::pair<int, int> pair;
  collision::ManifoldPoint point;
  const std::vector<RigidBodyState>* at;  // where the bodies are when it is there
};

class PositionCorrection {
 public:
  using Pair = ContactGeometry::Pair;

  /// @param memory  counts the sweeps of the step, but for those of large islands
  PositionCorrection(MovingWorld& moving, const ContactGeometry& geometry, ContactMemory& memory,
                     double restitution_threshold, RunCounters& counters)
      : moving_(moving),
        geometry_(geometry),
        memory_(memory),
        restitution_threshold_(restitution_threshold),
        counters_(counters) {}

  /// What is driven goes where its law has it at that time.
  void place_driven(std::vector<RigidBodyState>& states, double t) const;
  /// Takes back the overlaps of these pairs, in places of the time `t`.
  /// @return whether none is left
  bool correct_positions(const ContactIsland& island, const std::vector<Pair>& pairs,
                         std::vector<RigidBodyState>& states, double t,
                         const std::vector<ActiveContact>& active = {});
  /// The same for a large island, by a few sweeps a round.
  /// @param gaps  bounds from below, by pair; as good as needed afterwards [m]
  bool correct_large_island(const ContactIsland& island, const std::vector<Pair>& pairs,
                            std::vector<RigidBodyState>& states, double t,
                            std::vector<double>& gaps);

 private:
  struct Missing {
    double farthest = 0.0;  // that a point too near, or held too far, has to move [m]; 0: none has
    double too_near = 0.0;  // the same of points too near alone
    // as far apart as this, points of every pair have been looked at [m]
    double reach = std::numeric_limits<double>::infinity();
    std::vector<Pair> below_margin;
    std::vector<Vector3d> out_of_walls;  // normals of immovable bodies at points below the margin
    /// Whether two immovable bodies push against each other.
    bool is_between_walls() const;
  };
  struct KnownManifold {  // a pair's points as they were when it was last asked for them
    ContactManifold points;
    double reach = -1.0;  // all up to here [m]; negative: never asked
    double moved = 0.0;   // by any point of the two since, at most [m]
  };

  void place_for_correction(const ContactIsland& island, Pair pair,
                            const collision::ManifoldPoint& point,
                            const std::vector<RigidBodyState>& states, double t, double margin,
                            ContactProblem& problem, PushingContact& contact);
  bool apply_correction(int body, const Velocity& correction,
                        std::vector<RigidBodyState>& states) const;
  Missing add_corrections(const ContactIsland& island, const std::vector<Pair>& pairs,
                          const std::vector<RigidBodyState>& states, double t,
                          const std::vector<ActiveContact>& active, double reach,
                          ContactProblem& problem);
  bool keeps_margin(const Pair& pair, double t) const;
  bool give_up_margins(const std::vector<Pair>& pairs, double t);
  double way_of(int body, const Velocity& correction) const;
  ContactProblem corrections_of(const ContactIsland& island, const std::vector<Pair>& pairs,
                                const std::vector<RigidBodyState>& states, double t,
                                const std::vector<double>& gaps, double wrong,
                                const std::vector<double>& way,
                                std::vector<KnownManifold>& manifolds);

  MovingWorld& moving_;
  const ContactGeometry& geometry_;
  ContactMemory& memory_;
  double restitution_threshold_;  // [m/s]
  RunCounters& counters_;
  BodyPlaces places_;  // in the problem that is being set up
};

}  // namespace tumble::engines
