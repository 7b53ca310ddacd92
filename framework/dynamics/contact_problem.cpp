// How a contact problem is solved, cheapest first:
//   1. the guess: at rest with last step's impulses nothing is left to do;
//   2. block Gauss-Seidel sweeps: most small problems end here;
//   3. a Newton method on all contacts at once, for what sweeps do slowly (stacks, arches, mass ratios).
#include "framework/dynamics/contact_problem.h"

#include <cmath>

#include "framework/dynamics/contact_sweeps.h"
#include "framework/dynamics/contact_system.h"

namespace tumble {
namespace {

using contacts::ContactBlock;
using contacts::Impulses;
using contacts::System;

ContactMode mode_of(const ContactBlock& block, const Vector3d& impulse) {
  constexpr double kOnTheCone = 1 - 1e-9;  // nearer to the edge than this is on it: impulses of sliding contacts lie there to round-off
  if (!(impulse[0] > 0)) return ContactMode::kOpen;
  return impulse.tail<2>().norm() >= kOnTheCone * block.friction * impulse[0] ? ContactMode::kSlide : ContactMode::kStick;
}

/// Ends, and residual, of an iteration.
struct Judge {
  const System& system;
  double tolerance;

  double speed(const Impulses&) const { return system.speed > 0 ? system.speed : 1.0; }
  bool accepts(double violation, const Impulses& impulses) const {
    return violation <= tolerance * speed(impulses) || violation <= contacts::rounding_floor(system, impulses);
  }
};

/// Sweeps until the judge accepts, or their number is spent. Returns the violation.
double sweep_until(const Judge& judge, int most_sweeps, Impulses& impulses, int& sweeps) {
  const System& system = judge.system;
  const auto locals = contacts::prepare_locals(system);
  double violation = 0;
  for (int i = 0;; ++i) {
    const double change = i < most_sweeps ? contacts::sweep(system, locals, i % 2 == 0, impulses) : 0.0;
    if (i < most_sweeps) ++sweeps;
    // The change of a sweep is as large as the violation before it: only when it is small the true one is worth its price.
    if (i < most_sweeps && !judge.accepts(change, impulses)) continue;
    contacts::sum_impulses(system, impulses);
    violation = contacts::largest_violation(system, impulses);
    if (i >= most_sweeps || judge.accepts(violation, impulses)) return violation;
  }
}

ContactSolution describe(const ContactProblem& problem, const System& system, const Impulses& impulses) {
  ContactSolution solution;
  const std::size_t contacts = system.contacts.size();
  solution.impulses_world.reserve(contacts);
  solution.modes.reserve(contacts);
  for (std::size_t i = 0; i < contacts; ++i) {
    solution.impulses_world.push_back(system.contacts[i].contact_from_world.transpose() * impulses.contacts[i]);
    solution.modes.push_back(mode_of(system.contacts[i], impulses.contacts[i]));
  }
  solution.row_impulses = Eigen::Map<const VectorXd>(impulses.rows.data(), static_cast<Eigen::Index>(impulses.rows.size()));
  solution.velocities.reserve(problem.bodies.size());
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    const PushedBody& body = problem.bodies[i];
    solution.velocities.push_back({body.velocity_world + system.root_inverse_mass[i] * impulses.y[i].head<3>(),
                                   body.omega_world + system.root_inverse_inertia[i] * impulses.y[i].tail<3>()});
  }
  return solution;
}

}  // namespace

ContactSolution solve_contacts(const ContactProblem& problem, const ContactOptions& options) {
  const System system = contacts::build_system(problem);
  Impulses impulses = contacts::first_guess(system, problem);
  const Judge judge{system, options.tolerance};
  int sweeps = 0;
  double violation = contacts::largest_violation(system, impulses);
  if (!judge.accepts(violation, impulses)) violation = sweep_until(judge, options.most_sweeps_alone, impulses, sweeps);
  ContactSolution solution = describe(problem, system, impulses);
  solution.residual = violation / judge.speed(impulses);
  solution.converged = judge.accepts(violation, impulses);
  solution.sweeps = sweeps;
  return solution;
}

}  // namespace tumble
