// How a contact problem is solved, cheapest first:
//   1. the guess: at rest with last step's impulses nothing is left to do;
//   2. Newton's method on Coulomb's law, from the guess: bodies at rest or sliding steadily. From no guess at all it finds the most even
//      distribution among redundant contacts;
//   3. block Gauss-Seidel sweeps, which find the modes (open, stick, slide) where many change;
//   4. Newton's method again, by turns with its convex relative, which cannot get lost (contact_newton.h).
// Problems too large for 2 and 4 are left to the sweeps.
#include "framework/dynamics/contact_problem.h"

#include <cmath>

#include "framework/dynamics/contact_newton.h"
#include "framework/dynamics/contact_sweeps.h"
#include "framework/dynamics/contact_system.h"

namespace tumble {
namespace {

using contacts::ContactBlock;
using contacts::Goal;
using contacts::Impulses;
using contacts::Progress;
using contacts::System;

constexpr int kMostRounds = 30;       // of the two Newton methods by turns
constexpr int kFirstNewtonSteps = 8;  // from the guess: at rest two or three do; where they wander, sweeps are cheaper

ContactMode mode_of(const ContactBlock& block, const Vector3d& impulse) {
  constexpr double kOnTheCone = 1 - 1e-9;  // nearer to the edge than this is on it: impulses of sliding contacts lie there to round-off
  if (!(impulse[0] > 0)) return ContactMode::kOpen;
  return impulse.tail<2>().norm() >= kOnTheCone * block.friction * impulse[0] ? ContactMode::kSlide : ContactMode::kStick;
}

/// Sweeps until the goal is met, or their number is spent.
void sweep_until(const System& system, const Goal& goal, int most_sweeps, Impulses& impulses, Progress& progress, int& sweeps) {
  const auto locals = contacts::prepare_locals(system);
  while (sweeps < most_sweeps && !progress.accepted) {
    const double change = contacts::sweep(system, locals, sweeps % 2 == 0, impulses);
    ++sweeps;
    // The change of a sweep is about as large as the violation before it: only when it is small the true one is worth its price.
    if (sweeps < most_sweeps && !goal.accepts(system, impulses, change)) continue;
    contacts::sum_impulses(system, impulses);
    progress.violation = contacts::largest_violation(system, impulses);
    progress.accepted = goal.accepts(system, impulses, progress.violation);
  }
}

void iterate(const System& system, const Goal& goal, const ContactOptions& options, Impulses& impulses, Progress& progress, int& sweeps) {
  const std::size_t size = system.contacts.size() + system.rows.size();
  if (size == 1) sweep_until(system, goal, 1, impulses, progress, sweeps);  // exact
  if (progress.accepted) return;
  if (static_cast<int>(size) > options.largest_direct) {
    sweep_until(system, goal, options.most_sweeps_alone, impulses, progress, sweeps);
    return;
  }
  contacts::BodyMatrix matrix(system);
  contacts::finish(system, goal, kFirstNewtonSteps, matrix, impulses, progress);
  if (!progress.accepted) sweep_until(system, goal, options.most_sweeps, impulses, progress, sweeps);
  if (!progress.accepted) contacts::solve_together(system, goal, kMostRounds, matrix, impulses, progress);
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
  const double speed = system.speed > 0 ? system.speed : 1.0;
  const Goal goal{options.tolerance * speed};
  Progress progress;
  int sweeps = 0;
  progress.violation = contacts::largest_violation(system, impulses);
  progress.accepted = goal.accepts(system, impulses, progress.violation);
  if (!progress.accepted) iterate(system, goal, options, impulses, progress, sweeps);
  ContactSolution solution = describe(problem, system, impulses);
  solution.residual = progress.violation / speed;
  solution.converged = progress.accepted;
  solution.sweeps = sweeps;
  solution.factorisations = progress.factorisations;
  return solution;
}

}  // namespace tumble
