/// Which pairs and points a step can bring together, where impacts are solved in steps: the fewer,
/// the smaller are its problems.
#pragma once

#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "framework/engines/contact/contact_geometry.h"
#include "framework/engines/contact/pair_table.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

class ContactReach {
 public:
  using Pair = ContactGeometry::Pair;  // bodies, first < second

  ContactReach(MovingWorld& moving, const ContactGeometry& geometry)
      : moving_(moving), geometry_(geometry) {}

  /// Nothing is known of the step that begins.
  void clear();
  /// Looks at a step in which impacts are solved.
  /// @param candidates  pairs whose boxes meet in it
  /// @param plastic     whether an impact between the two is dealt with in the step
  /// @return the pairs that their speeds may bring together; of these may_meet() is asked
  std::vector<Pair> look(const std::vector<Pair>& candidates, const std::set<Pair>& persistent,
                         const std::function<bool(Pair)>& plastic);
  /// Whether look() has found that the two may meet.
  bool may_meet(Pair pair) const { return reach_of_.contains(pair); }
  /// How much nearer the two can come in the step. [m]
  double of(Pair pair) const;
  /// Whether a point may close its gap within this time [s]. @pre look()
  bool may_close(Pair pair, const collision::ManifoldPoint& point, double time) const;
  /// At the step's start, of what meets others in it. [m/s] @pre look()
  Vector3d velocity_of_point(int body, const Vector3d& point_world) const;

 private:
  double farthest(Pair pair) const;
  std::vector<double> speeds_about(const std::vector<Pair>& candidates) const;
  double bend(Pair pair) const;
  double way(Pair pair, const Vector3d& normal_b_to_a_world) const;
  double chord_depth(int body) const;

  MovingWorld& moving_;
  const ContactGeometry& geometry_;
  // by body: how fast it or what it meets is [m/s]
  std::vector<double> speeds_;
  // by body: how far the path of the step may be from where it leads without contacts [m]
  std::vector<double> bends_;
  std::vector<Velocity> velocities_;  // by body, at the step's start
  PairTable<double> reach_of_;        // of pairs that may meet [m]
};

}  // namespace tumble::engines
