#include "tests/stability/methods.h"

#include <cmath>
#include <vector>

#include "framework/dynamics/solve_contacts.h"
#include "framework/dynamics/methods.h"

namespace tumble::battery {
Laws with_method(
    Laws laws, const std::string& name,
    std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)> step) {
  laws.integrate_step = std::move(step);
  laws.integrator_source = name;
  return laws;
}

VectorXd explicit_euler(const OdeFunction& f, double t, const VectorXd& y, double h) {
  static const StepFunction step = step_of(method_named("euler"), kUnset);
  return step(f, t, y, h);
}

VectorXd symplectic_euler(const OdeFunction& f, double t, const VectorXd& y, double h) {
  static const StepFunction step = step_of(method_named("symplectic"), kUnset);
  return step(f, t, y, h);
}

VectorXd verlet(const OdeFunction& f, double t, const VectorXd& y, double h) {
  static const StepFunction step = step_of(method_named("verlet"), kUnset);
  return step(f, t, y, h);
}

VectorXd implicit_midpoint(const OdeFunction& f, double t, const VectorXd& y, double h) {
  constexpr int kMostRounds = 200;
  VectorXd change = h * f(t, y), last = change;
  for (int round = 0; round < kMostRounds; ++round) {
    last.swap(change);
    change = h * f(t + 0.5 * h, y + 0.5 * last);
    if ((change - last).norm() <= 1e-16 * y.norm()) break;
  }
  return y + change;
}

VectorXd rk4(const OdeFunction& f, double t, const VectorXd& y, double h) {
  static const Laws library = library_laws();
  return library.integrate_step(f, t, y, h);
}

std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)> dormand_prince(
    double tolerance) {
  return step_of(method_named("dopri5"), tolerance);
}

Quaterniond exponential_step(const Quaterniond& q, const Vector3d& L, const Vector3d& moments,
                             double h) {
  const double spin = (q.conjugate() * L).z() / moments.z(), rate = L.norm() / moments.x();
  const Quaterniond precession(Eigen::AngleAxisd(h * rate, L.normalized())),
      own(Eigen::AngleAxisd(h * spin * (1 - moments.z() / moments.x()), Vector3d::UnitZ()));
  return (precession * q * own).normalized();
}

// Accelerations in the place of velocities: the rows shall accelerate as wanted, whatever their
// velocity product.
Laws with_gauss_seidel(Laws laws, int sweeps) {
  laws.constraint_multipliers = [sweeps](const std::vector<Constraint>& rows,
                                         const std::vector<ConstrainedBody>& bodies,
                                         const VectorXd& wanted) -> VectorXd {
    ContactProblem problem;
    for (const ConstrainedBody& body : bodies)
      problem.bodies.push_back({body.inverse_mass, body.inverse_inertia_world, Vector3d::Zero(),
                                body.free_acceleration.head<3>(),
                                body.free_acceleration.tail<3>()});
    problem.rows = rows;
    problem.row_targets = wanted;
    for (std::size_t i = 0; i < rows.size(); ++i)
      problem.row_targets[static_cast<Eigen::Index>(i)] -= rows[i].row.velocity_product;
    ContactOptions options;
    options.largest_direct = 0;
    options.eliminates_links = false;
    options.most_sweeps_alone = sweeps;
    return solve_contacts(problem, options).row_impulses;
  };
  return laws;
}

}  // namespace tumble::battery
