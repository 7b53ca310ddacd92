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

constexpr int kMostRounds = 16;         // of sweeps and both Newton methods by turns
constexpr int kNewtonSteps = 30;        // in a round
constexpr int kRoundsOfFewSweeps = 2;   // after these each round sweeps twice as often as the one before
constexpr int kMostSweepsARound = 1000;
constexpr double kFirstCompliance = 1e-2, kLeastCompliance = 1e-5;  // over a contact's own give: of the convex problem
constexpr int kFirstNewtonSteps = 8;    // from the guess: at rest two or three do; where they wander, sweeps are cheaper

ContactMode mode_of(const ContactBlock& block, const Vector3d& impulse) {
  constexpr double kOnTheCone = 1 - 1e-9;  // nearer to the edge than this is on it: impulses of sliding contacts lie there to round-off
  if (!(impulse[0] > 0)) return ContactMode::kOpen;
  return impulse.tail<2>().norm() >= kOnTheCone * block.friction * impulse[0] ? ContactMode::kSlide : ContactMode::kStick;
}

/// Sweeps until the goal is met, or their number is spent.
void sweep_until(const Goal& goal, const std::vector<contacts::LocalContact>& locals, int most_sweeps, Progress& progress) {
  for (int i = 0; i < most_sweeps && !progress.accepted; ++i) {
    const double change = contacts::sweep(goal.system, locals, i % 2 == 0, progress.impulses);
    ++progress.sweeps;
    // The change of a sweep is about as large as the violation before it: only when it is small the true one is worth its price.
    if (i + 1 < most_sweeps && !goal.accepts(progress.impulses, change)) continue;
    contacts::sum_impulses(goal.system, progress.impulses);
    goal.measure(progress);
  }
}

/// Sweeps, Newton's method, and the convex problem by turns; ends with the best that was met.
void solve_by_turns(const Goal& goal, const std::vector<contacts::LocalContact>& locals, int sweeps, contacts::BodyMatrix& matrix, Progress& progress) {
  double compliance = kFirstCompliance;
  Progress best = progress;
  const auto try_to_finish = [&] {
    contacts::finish(goal, kNewtonSteps, matrix, progress);
    if (progress.accepted || progress.violation.squares < best.violation.squares) best = progress;
  };
  for (int round = 0; round < kMostRounds && !progress.accepted; ++round) {
    sweep_until(goal, locals, sweeps, progress);
    if (!progress.accepted) try_to_finish();
    if (progress.accepted) break;
    const bool reached = contacts::soften(goal, compliance, matrix, progress);
    compliance = reached ? std::max(kLeastCompliance, 0.1 * compliance) : std::min(1.0, 10 * compliance);
    if (reached) try_to_finish();
    if (round >= kRoundsOfFewSweeps) sweeps = std::min(2 * sweeps, kMostSweepsARound);
  }
  if (!progress.accepted) {
    best.sweeps = progress.sweeps;
    best.factorisations = progress.factorisations;
    progress = std::move(best);
  }
}

void iterate(const Goal& goal, const ContactOptions& options, Progress& progress) {
  const std::size_t size = goal.system.contacts.size() + goal.system.rows.size();
  if (static_cast<int>(size) > options.largest_direct || size == 1) {  // one contact: the first sweep is exact
    sweep_until(goal, contacts::prepare_locals(goal.system), options.most_sweeps_alone, progress);
    return;
  }
  contacts::BodyMatrix matrix(goal.system);
  contacts::finish(goal, kFirstNewtonSteps, matrix, progress);
  if (!progress.accepted) solve_by_turns(goal, contacts::prepare_locals(goal.system), options.most_sweeps, matrix, progress);
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
  const double speed = system.speed > 0 ? system.speed : 1.0;
  const Goal goal{system, options.tolerance * speed};
  Progress progress;
  progress.impulses = contacts::first_guess(system, problem);
  goal.measure(progress);
  if (!progress.accepted) iterate(goal, options, progress);
  ContactSolution solution = describe(problem, system, progress.impulses);
  solution.residual = progress.violation.largest / speed;
  solution.converged = progress.accepted;
  solution.sweeps = progress.sweeps;
  solution.factorisations = progress.factorisations;
  return solution;
}

}  // namespace tumble
