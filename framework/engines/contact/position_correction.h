/// Position correction: takes back what turning, rounding and the errors of solvers leave of overlaps.
///
/// Bodies are shifted by what is smallest in the kinetic metric (each body's shift weighs by its mass and inertia), so that no gap stays below its
/// margin and no rod or joint opens; velocities stay. Linear complementarity for the gaps, equality for rows: the contact solver answers both.
#pragma once

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
  collision::NearPoint point;
  const std::vector<RigidBodyState>* at;   // where the bodies are when it is there
};

class PositionCorrection {
 public:
  using Pair = ContactGeometry::Pair;

  /// @param memory  counts the sweeps of the step
  PositionCorrection(MovingWorld& moving, const ContactGeometry& geometry, ContactMemory& memory, double rest_speed, RunCounters& counters)
      : moving_(moving), geometry_(geometry), memory_(memory), rest_speed_(rest_speed), counters_(counters) {}

  /// Takes back the overlaps of these pairs, in places of the time `t`. @return whether none is left
  bool keep_apart(const ContactIsland& island, const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t, const std::vector<ActiveContact>& held = {});
  /// The same for a heap, by a few sweeps a round. @param gaps  bounds from below, by pair; as good as needed afterwards [m]
  bool keep_pile_apart(const ContactIsland& island, const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t, std::vector<double>& gaps);

 private:
  struct KnownManifold {           // a pair's points as they were when it was last asked for them
    ContactManifold points;
    double reach = -1.0;           // all up to here [m]; negative: never asked
    double moved = 0.0;            // by any point of the two since, at most [m]
  };

  void place_for_shift(const ContactIsland& island, Pair pair, const collision::NearPoint& point, const std::vector<RigidBodyState>& states, double t, double room, std::map<int, int>& places,
                       ContactProblem& problem, PushingContact& contact);
  bool apply_shift(int body, const Velocity& shift, std::vector<RigidBodyState>& states) const;
  double add_shifts(const ContactIsland& island, const std::vector<Pair>& pairs, const std::vector<RigidBodyState>& states, double t, const std::vector<ActiveContact>& held, double reach,
                    std::map<int, int>& places, ContactProblem& problem);
  double way_of(int body, const Velocity& shift) const;
  ContactProblem shifts_of(const ContactIsland& island, const std::vector<Pair>& pairs, const std::vector<RigidBodyState>& states, double t, const std::vector<double>& gaps, double wrong,
                           const std::vector<double>& way, std::vector<KnownManifold>& faced);

  MovingWorld& moving_;
  const ContactGeometry& geometry_;
  ContactMemory& memory_;
  double rest_speed_;              // [m/s]
  RunCounters& counters_;
};

}  // namespace tumble::engines
