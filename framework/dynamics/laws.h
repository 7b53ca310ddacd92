/// The laws by which a world moves, as replaceable functions: an engine asks these and never knows
/// their author.
///
/// Each assignment fills the laws it is about (its `bind`); what no module fills stays empty, and
/// an engine that needs an empty law says which assignment provides it. `library_laws()` fills
/// integration from a library, so that scenes run before a student has written an integrator.
/// What stands here is asked by engines, or by more than one room; a law that one effect alone asks
/// stands in the effect's folder and is listed by its type (law_list.h).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "framework/dynamics/body.h"
#include "framework/dynamics/constraint.h"
#include "framework/dynamics/contact_problem.h"
#include "framework/dynamics/law_list.h"
#include "framework/dynamics/ode.h"
#include "framework/dynamics/scheduling.h"

namespace tumble {

struct Laws : LawList {
  // Impulses and point forces (assignment a1).
  std::function<double(const Contact&, const Body& a, const Body& b)> relative_normal_velocity;
  std::function<double(const Contact&, const Body& a, const Body& b, double restitution)>
      collision_impulse;
  std::function<Velocity(const Body&, const Vector3d& impulse_world, const Vector3d& point_world)>
      apply_impulse;
  std::function<Wrench(const Vector3d& force_world, const Vector3d& point_world,
                       const Vector3d& com_world)>
      wrench_of_point_force;
  std::function<std::optional<RayHit>(const Ray&, const Triangle&)> intersect_ray_triangle;

  // Motion (assignment a2).
  /// One step of the method: y(t) to y(t + h).
  std::function<VectorXd(const OdeFunction& f, double t, const VectorXd& y, double h)>
      integrate_step;
  /// Whether it compares numbers of y with one size (a tolerance, the step of a difference):
  /// engines then give it y, and slopes, in units of the bodies (dynamics/state_units.h).
  bool steps_in_units = false;
  /// d/dt of a rigid body's packed state (13) under a wrench.
  std::function<VectorXd(const RigidBodyState&, const Inertia&, const Wrench&)> state_derivative;
  /// Brings the quaternion back to unit length after a step.
  std::function<Quaterniond(const Quaterniond&)> renormalize;
  /// A time of impact in [t_low, t_high], where the gap changes from + to -.
  std::function<RootResult(const ScalarFunction& gap, const ScalarFunction& gap_rate, double t_low,
                           double t_high, double tolerance)>
      find_impact_time;

  // Springs, rods and joints, resting contact (assignment a3).
  /// Force of a spring on the body at its end A; on B acts the opposite. World frame. [N]
  std::function<Vector3d(const Spring&, const AnchorState& a, const AnchorState& b)> spring_force;
  /// The C'' that brings a constraint back (Baumgarte). [m/s^2]
  std::function<double(double value, double rate, double time_constant_s)> baumgarte_acceleration;
  /// lambda (m) at which every C'' is what is wanted, (m).
  std::function<VectorXd(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                         const VectorXd& wanted_acceleration)>
      constraint_multipliers;
  /// The change (6n) of places or velocities, smallest in the measure of the masses, with J change
  /// = -error.
  std::function<VectorXd(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                         const VectorXd& error)>
      constraint_correction;
  /// f (m) >= 0 with a = A f + b >= 0 and f . a = 0.
  std::function<VectorXd(const MatrixXd& A, const VectorXd& b)> contact_forces;
  /// Impulses of contacts with friction. Empty: the framework's own solve_contacts.
  std::function<ContactSolution(const ContactProblem&, const ContactOptions&)> friction_impulses;
  /// Whether a collision would rebound so slowly that it is the beginning of a persistent contact.
  std::function<bool(double approach_speed, double restitution, double restitution_threshold)>
      ends_in_contact;

  /// Whether rods and joints are not what a run is to show: where a scene leaves the choice of
  /// coordinates, it may then go without their rows.
  bool rows_are_given = false;

  // Decisions of a timewarp scheduler (assignment a4). Filled: --engine tw asks them.
  Scheduling scheduling;

  // which module provides the impulse laws, for pictures and records
  std::string impulse_source = "none";
  std::string integrator_source = "none";  // which module provides integration
  // what that module calls integrate_step, state_derivative and find_impact_time, for messages
  std::string step_function = "integrate_step", derivative_function = "state_derivative",
              impact_time_function = "find_impact_time";
  // which module provides springs, rods and contact forces
  std::string constraint_source = "none";
  std::string scheduling_source = "none";  // which module provides the scheduler
  // what stands in the place of the module's own solvers of links and of contacts
  // (iterative_solvers.h); empty: nothing, they are constraint_source's. Springs are
  // constraint_source's in any case, and so are the rows of rods, which are listed (RodRow).
  std::string link_solver{}, contact_solver{};

  /// Where multipliers and corrections of links, and where contact_forces, come from.
  const std::string& source_of_links() const {
    return link_solver.empty() ? constraint_source : link_solver;
  }
  const std::string& source_of_contacts() const {
    return contact_solver.empty() ? constraint_source : contact_solver;
  }
};

/// Laws of motion from Boost.Odeint (classical Runge-Kutta) and Boost.Math (TOMS 748 bracketing);
/// no impulse laws.
Laws library_laws();

}  // namespace tumble
