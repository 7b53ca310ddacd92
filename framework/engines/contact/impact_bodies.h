/// Bodies at the instant of an impact: what an impulse between two of them does to all that are
/// linked to them.
///
/// An impulse acts on the constrained system. The bodies take it as if they were free (the laws'
/// apply_impulse), and within the same instant rods and joints add impulses of their own (the laws'
/// constraint_correction), after which their rates are what they were. Both are linear in the
/// impulse, so a contact of linked bodies has an inverse effective mass as a contact of free ones
/// has, with what holds them in it:   K_held = D^T P M^-1 J_c^T D,   with P the projection of
/// velocities along the rows, D the directions asked for. Bodies without rods and joints pay for
/// none of this.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

Vector3d velocity_at(const Body& body, const Vector3d& point_world);

/// Of A against B at a point. [m/s]
Vector3d relative_velocity(const Body& a, const Body& b, const Vector3d& point_world);

/// K of one free body at a point: its velocity there per impulse, (3,3), world. [1/kg]
Matrix3d inverse_effective_mass(const Body& body, const Vector3d& point_world);

/// Kinetic energy of bodies whose velocities jump, seen from a frame that moves with what is
/// driven: there walls do no work.
struct EnergyOfImpact {
  double before = 0.0, change = 0.0;  // [J]; NaN where bodies driven in different ways take part
  double mass = 0.0;                  // of all that is moved [kg]

  void add(const Inertia& inertia, const Quaterniond& world_from_body, const Velocity& from,
           const Velocity& to, const Vector3d& seen_from_world);
  /// How far the change is from what the law says, or above 0, over the energy before; over that of
  /// a speed that matters where there is less. What bodies at rest are left with are roundings of
  /// the speeds that they had a moment before.
  /// @param least_speed  that matters [m/s]
  double excess(double by_law, double least_speed) const;
};

/// The velocities that the bodies of a problem have before its impulses.
std::vector<Velocity> velocities_of(const ContactProblem& problem);

/// What the impulses of contacts do to the kinetic energy: sum of p . (u + u') / 2, u of A against
/// B at each contact. [J]
/// @param impulses_world  by contact, on A [N s];   from, to  velocities before and after, by body
/// of the problem
double work_of(const ContactProblem& problem, const std::vector<Vector3d>& impulses_world,
               const std::vector<Velocity>& from, const std::vector<Velocity>& to);

/// What the impulses of rows do to it, seen like EnergyOfImpact: sum of lambda J . (u + u') / 2. It
/// is 0 where links are at rest in themselves (J u = 0); where they drift, the impulses that keep
/// their rates as they are do work with them, which is neither restitution's nor friction's. [J]
double work_of_rows(const ContactProblem& problem, const VectorXd& row_impulses,
                    const std::vector<Velocity>& from, const std::vector<Velocity>& to,
                    const Vector3d& seen_from_world);

/// Two bodies that touch at a point, as impulses there find them.
struct TouchedPoint {
  int a, b;  // bodies
  Vector3d point_world, normal_b_to_a_world;
};

class ImpactBodies {
 public:
  ImpactBodies(MovingWorld& moving, const Laws& laws) : moving_(moving), laws_(laws) {}

  MovingWorld& moving() { return moving_; }
  /// As it is between impulses.
  Body& body(int index);
  const std::set<int>& changed() const { return changed_; }
  void set_velocity(int index, const Velocity& velocity);
  /// Hands the velocities of changed bodies to the world.
  void write_back();

  /// Whether rods or joints hold one of the two.
  bool is_held(int a, int b) const { return held_group(a) >= 0 || held_group(b) >= 0; }
  /// Place of the group of linked bodies that holds a body by rods or joints; -1: none does.
  int held_group(int body) const;
  /// Velocities of the groups of both onto their rods and joints: an impact begins there. Once for
  /// each group.
  /// @return whether any was put there now
  bool put_on_constraints(int a, int b);

  /// How the two answer to impulses at a point.
  struct Answer {
    Matrix3d free_world = Matrix3d::Zero();  // K of the free bodies [1/kg]
    // of which `held` speaks: the normal; with friction two tangents besides
    Eigen::Matrix<double, 3, Eigen::Dynamic> directions;
    // K with what holds them, in these directions [1/kg]
    MatrixXd held;
    struct Reaction {
      int group;
      // (6 a body of the group, directions): by the links, per unit impulse
      MatrixXd velocities;
    };
    // empty: no rod or joint holds them, or they were not asked for
    std::vector<Reaction> reactions;

    double free_along(const Vector3d& direction) const {
      return direction.dot(free_world * direction);
    }
    /// Along the normal.
    double held_normal() const { return held(0, 0); }
    Matrix3d held_world() const { return directions * held * directions.transpose(); }
  };
  /// @param with_tangents  whether impulses along the surface are asked about, too
  Answer answer(const TouchedPoint& touched, bool with_tangents);

  /// Impulse on A at the point, its opposite on B, and what links make of it.
  /// @return what that did to the kinetic energy
  EnergyOfImpact push(const TouchedPoint& touched, const Answer& answer,
                      const Vector3d& impulse_world);

  /// The velocity of what is driven among these bodies and the ends of their links; 0 without;
  /// nothing where they differ. [m/s]
  std::optional<Vector3d> driven_velocity(const std::vector<int>& bodies);

 private:
  LinkedBodies::Instant& instant(int group);

  MovingWorld& moving_;
  const Laws& laws_;
  std::map<int, Body> bodies_;
  std::set<int> changed_;
  std::map<int, LinkedBodies::Instant> instants_;  // of groups that have been asked
  std::set<int> on_constraints_;                   // groups
};

}  // namespace tumble::engines
