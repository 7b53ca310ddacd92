/// Contacts with Coulomb friction: which impulses keep bodies from entering each other during a
/// step.
///
/// The bodies have velocities u (6 a body: linear, angular, world) that they would reach without
/// contact forces. Contact i acts at one point, with a unit normal n_i from B to A and two
/// tangents; its impulse p_i = (p_n, p_t1, p_t2) changes the velocities by M^-1 J^T p. With v_i the
/// relative velocity of A against B at the point after all impulses:
///   p_n >= 0,   v_n >= target,   p_n (v_n - target) = 0
///       (signorini)                                                                          (C.1)
///   |p_t| <= mu p_n;   where |p_t| < mu p_n: v_t = 0;   else v_t = -s p_t, s >= 0
///       (Coulomb, a cone, no pyramid)                                                        (C.2)
/// Equality rows (rods, joints inside the group) hold J u = target with an impulse of any sign.
/// (C.3) Such an impulse always exists for target <= 0 and no equality rows; it need not be unique
/// (a table on four legs: contact_spread.h says which is taken among links), nor are the velocities
/// always unique where friction is large. The same problem gives the same bits.
/// Sources: D. Stewart, J. Trinkle, Int. J. Numer. Meth. Eng. 39, 1996; V. Acary, B. Brogliato,
/// "Numerical methods for nonsmooth dynamical systems", 2008, ch. 13; G. De Saxce, Z.-Q. Feng,
/// Math. Comput. Modelling 28, 1998.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/dynamics/constraint.h"

namespace tumble {

/// A body of the group. Inverse mass 0 and zero inverse inertia: it cannot be pushed.
struct PushedBody {
  double inverse_mass = 0.0;                          // [1/kg]
  Matrix3d inverse_inertia_world = Matrix3d::Zero();  // [1/(kg m^2)]
  Vector3d com_world = unset_vector();                // [m]
  Vector3d velocity_world = unset_vector();           // without contact impulses [m/s]
  Vector3d omega_world = unset_vector();              // [rad/s]
};

struct PushingContact {
  int body_a = 0, body_b = 0;                     // indices into the group's bodies
  Vector3d point_world = unset_vector();          // [m]
  Vector3d normal_b_to_a_world = unset_vector();  // unit
  double friction = 0.0;                          // mu >= 0
  // least normal velocity afterwards [m/s]; < 0 where there is room left
  double target = 0.0;
  // v_t in (C.2) counts from here: a conveyor, a point that moves on [m/s]
  Vector3d slip_target_world = Vector3d::Zero();
  // impulse on A to begin from (the last step's) [N s]
  Vector3d warm_start_world = Vector3d::Zero();
};

struct ContactProblem {
  std::vector<PushedBody> bodies;
  std::vector<PushingContact> contacts;
  // equality rows; value, rate and velocity_product are not looked at
  std::vector<Constraint> rows;
  VectorXd row_targets;  // (rows): J u afterwards [m/s]
};

enum class ContactMode : std::uint8_t { kOpen, kStick, kSlide };

/// What tells which of several contacts carries a load (contact_spread.h).
enum class LoadSharing {
  kStatics,    // or it is not asked: ContactOptions::indistinct
  kMostEven,   // statics does not: it is spread most evenly
  kUndecided,  // statics does not, and no even load was found: where the answer came from does
};

struct ContactSolution {
  std::vector<Vector3d> impulses_world;  // by contact, on A [N s]
  std::vector<ContactMode> modes;        // by contact
  VectorXd row_impulses;                 // by row
  std::vector<Velocity> velocities;      // by body, afterwards
  // largest violation of (C.1) to (C.3), as a velocity, over the problem's speed
  double residual = 0.0;
  bool converged = false;              // residual <= tolerance
  int sweeps = 0, factorisations = 0;  // what it cost
  LoadSharing sharing = LoadSharing::kStatics;
  bool by_contact_forces = false;  // found by the laws' contact_forces, not by such a solver
};

struct ContactOptions {
  double tolerance = 1e-12;  // relative to the problem's speed
  double least_speed = 0.0;  // or a velocity this small [m/s]
  // of block Gauss-Seidel where Newton's method from the warm start fails; then 4 times so many
  int most_sweeps = 50;
  // contacts and rows: beyond, sweeps only
  int largest_direct = 600;
  // relative: what Newton's method and sweeps reach is taken if it is as good as this
  double enough = 0.0;
  // where the direct method is not called
  int most_sweeps_alone = 2000;
  // where there are rows: contacts that open or approach with less than this do so by errors, which
  // do not tell which of them carries a load. Above 0: where statics does not, either, the load is
  // spread most evenly over them (contact_spread.h) [m/s]
  double indistinct = 0.0;
  // bodies that hang on rows and touch nothing are left out, as far as this can be done
  bool eliminates_links = true;
};

}  // namespace tumble
