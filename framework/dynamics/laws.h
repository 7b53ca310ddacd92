/// The laws by which a world moves, as replaceable functions: an engine asks these and never knows who wrote them.
///
/// Each assignment fills the laws it is about (its `bind`); what nobody filled stays empty, and an engine that needs an
/// empty law says which assignment provides it. `library_laws()` fills integration from a library, so that scenes run
/// before a student has written an integrator.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "framework/dynamics/body.h"
#include "framework/dynamics/ode.h"

namespace tumble {

struct Laws {
  // Impulses and point forces (assignment a1).
  std::function<double(const Contact&, const Body& a, const Body& b)> relative_normal_velocity;
  std::function<double(const Contact&, const Body& a, const Body& b, double restitution)> collision_impulse;
  std::function<Velocity(const Body&, const Vector3d& impulse_world, const Vector3d& point_world)> apply_impulse;
  std::function<Wrench(const Vector3d& force_world, const Vector3d& point_world, const Vector3d& com_world)> wrench_of_point_force;
  std::function<std::optional<RayHit>(const Ray&, const Triangle&)> intersect_ray_triangle;

  // Motion (assignment a2).
  /// One step of the method: y(t) to y(t + h).
  std::function<VectorXd(const OdeFunction& f, double t, const VectorXd& y, double h)> integrate_step;
  /// d/dt of a rigid body's packed state (13) under a wrench.
  std::function<VectorXd(const RigidBodyState&, const Inertia&, const Wrench&)> state_derivative;
  /// Brings the quaternion back to unit length after a step.
  std::function<Quaterniond(const Quaterniond&)> renormalize;
  /// A time of impact in [t_low, t_high], where the gap changes from + to -.
  std::function<RootResult(const ScalarFunction& gap, const ScalarFunction& gap_rate, double t_low, double t_high, double tolerance)>
      find_impact_time;

  std::string impulse_source = "none";      // who provides the impulse laws, for pictures and records
  std::string integrator_source = "none";   // who provides integration
};

/// Laws of motion from Boost.Odeint (classical Runge-Kutta) and Boost.Math (TOMS 748 bracketing); no impulse laws.
Laws library_laws();

}  // namespace tumble
