// How a contact problem is solved. Bodies that hang on links and touch nothing are left out
// (contact_links.h), and what they do follows at last; where that does not solve all rows as well
// as is asked for, they are left in. The rest, cheapest first:
//   1. the warm start: at rest with last step's impulses nothing is left to do;
//   2. Newton's method on Coulomb's law, from the warm start: bodies at rest or sliding steadily.
//      From zero it finds the most even distribution among redundant contacts;
//   3. what stands: contacts stick, or are open where they would have to pull. Coulomb's law can
//      have several answers (a rod that jams while it slides, stones of an arch that could as well
//      slip); this takes the one in which nothing slides, and what is symmetric stays so;
//   4. block Gauss-Seidel sweeps, which find the modes (open, stick, slide) where many change;
//   5. the law with rounded edges, made sharp step by step, at three paces;
//   6. Newton's method again, by turns with its convex relative, which cannot get lost
//      (contact_newton.h). Of what is nearly solved, only as long as it gets better: loads that
//      many contacts share in ways that do not fit by a hundred-millionth of a speed move on
//      through all of them without end.
// Problems too large for 2, 3, 5 and 6 are left to the sweeps. Of contacts between linked bodies,
// what statics does not tell is made even at last (contact_spread.h).
#include "framework/dynamics/solve_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "framework/dynamics/contact_cone.h"
#include "framework/dynamics/contact_links.h"
#include "framework/dynamics/contact_newton.h"
#include "framework/dynamics/contact_spread.h"
#include "framework/dynamics/contact_sweeps.h"
#include "framework/dynamics/contact_system.h"

namespace tumble {
namespace {

using contacts::ContactBlock;
using contacts::Goal;
using contacts::Impulses;
using contacts::Progress;
using contacts::System;

// from the warm start: at rest two or three do; where they wander, sweeps are cheaper
constexpr int kFirstNewtonSteps = 8;
constexpr int kNewtonSteps = 30;  // later
// of the violation that is asked for: what others add to a solved contact before a sweep solves it
// again. Together with what the sweep itself leaves it stays below what is asked for
constexpr double kNegligible = 0.1;
constexpr int kSweepRounds = 2;  // each of four times as many sweeps as the one before
constexpr int kFewSoftRounds = 10, kManySoftRounds = 200, kFinishEvery = 5;
// where one pace ends in a fold, another does not
constexpr contacts::Sharpening kPaces[] = {{0.1, 0.6, 80}, {0.1, 0.2, 80}, {0.01, 0.75, 120}};
// of the speed: what contacts may approach with where links hold them
constexpr double kHeldApproach = 1e-6;
// times the goal: nearly solved
constexpr double kNearly = 10;
// soft rounds in which what is nearly solved has to halve its sum of squares
constexpr int kPatience = 10;
constexpr int kLastRounds = 3, kLastSweeps = 500;
// cosine squared between two steps whose sum may be extrapolated
constexpr double kSteady = 0.9;
// of the convex problems, over a contact's own give
constexpr double kFirstCompliance = 1e-2, kLeastCompliance = 1e-4, kSteadyCompliance = 1e-6;
// of the path
constexpr double kSoftest = 10, kWorthFinishing = 0.05, kHardest = 1e-7, kPathStep = 0.3;

ContactMode mode_of(const ContactBlock& block, const Vector3d& impulse) {
  // nearer to the edge than this is on it: impulses of sliding contacts lie there to round-off
  constexpr double kOnTheCone = 1 - 1e-9;
  if (!(impulse[0] > 0)) return ContactMode::kOpen;
  return impulse.tail<2>().norm() >= kOnTheCone * block.friction * impulse[0] ? ContactMode::kSlide
                                                                              : ContactMode::kStick;
}

/// Sweeps until the goal is met, or their number is spent.
void sweep_until(const Goal& goal, contacts::Sweeper& sweeper, int most_sweeps,
                 Progress& progress) {
  sweeper.begin();
  for (int i = 0; i < most_sweeps && !progress.accepted; ++i) {
    const contacts::Sweeper::Swept swept = sweeper.sweep(i % 2 == 0, progress.impulses);
    ++progress.sweeps;
    // The change of a sweep is about as large as the violation before it: only when it is small the
    // true one is worth its price.
    if (i + 1 < most_sweeps && swept.change > goal.violation && swept.change > swept.rounding)
      continue;
    contacts::sum_impulses(goal.system, progress.impulses);
    sweeper.begin();
    goal.measure(progress);
  }
}

/// The means by turns, cheap ones first; `best` is the best that was met.
class Turns {
 public:
  /// @param enough  a violation this small is not worth dearer means [m/s]
  Turns(const Goal& goal, double enough, contacts::BodyMatrix& matrix, Progress& progress)
      : goal_(goal),
        enough_(enough),
        sweeper_(goal.system, kNegligible * goal.violation),
        matrix_(matrix),
        now_(progress),
        best_(progress) {}

  void run(int sweeps) {
    for (int round = 0; round < kSweepRounds && !done(); ++round)
      sweep_and_finish(sweeps << (2 * round));
    for (const contacts::Sharpening& pace : kPaces)
      if (!done()) sharpen(pace);
    if (!done()) go_on();
    if (!done() && now_.violation.squares < best_.violation.squares) best_ = now_;
    best_.sweeps = now_.sweeps;
    best_.factorisations = now_.factorisations;
    now_ = std::move(best_);
  }

 private:
  bool is_nearly_solved() const { return best_.violation.largest <= kNearly * goal_.violation; }
  bool done() const { return best_.accepted || best_.violation.largest <= enough_; }

  void go_on() {
    if (!done()) soften(kFewSoftRounds, kLeastCompliance);
    if (!done() && !is_nearly_solved()) follow();
    if (!done()) soften(kManySoftRounds, kSteadyCompliance);
    for (int round = 0; round < kLastRounds && !done(); ++round) {
      take_best();
      sweep_and_finish(kLastSweeps);
    }
  }

  /// Newton's method on the law, from where we are. It leaves us there: where it fails it has gone
  /// astray.
  void try_to_finish() {
    Progress trial = now_;
    contacts::finish(goal_, kNewtonSteps, matrix_, trial);
    now_.factorisations = trial.factorisations;
    if (trial.accepted || trial.violation.squares < best_.violation.squares)
      best_ = std::move(trial);
  }

  /// The rounded law, and Newton's method from where that has led. It leaves us where we are.
  void sharpen(const contacts::Sharpening& pace) {
    Progress trial = now_;
    contacts::sharpen(goal_, pace, matrix_, trial);
    if (!trial.accepted) contacts::finish(goal_, kNewtonSteps, matrix_, trial);
    now_.factorisations = trial.factorisations;
    if (trial.accepted || trial.violation.squares < best_.violation.squares)
      best_ = std::move(trial);
  }

  void sweep_and_finish(int sweeps) {
    sweep_until(goal_, sweeper_, sweeps, now_);
    try_to_finish();
  }

  void take_best() {
    const Progress counts = now_;
    now_ = best_;
    now_.sweeps = counts.sweeps;
    now_.factorisations = counts.factorisations;
  }

  /// Where steps fall by a steady ratio, their sum is known (Aitken): goes there, and back again if
  /// that is no better.
  void extrapolate(const Impulses& second_last, const Impulses& last) {
    double before = 0, after = 0, product = 0;
    for (std::size_t i = 0; i < last.y.size(); ++i) {
      const Vector6d step = last.y[i] - second_last.y[i], next = now_.impulses.y[i] - last.y[i];
      before += step.squaredNorm();
      after += next.squaredNorm();
      product += step.dot(next);
    }
    const double ratio = product / before;
    if (!(ratio > 0.3 && ratio < 0.999 && product * product > kSteady * before * after)) return;
    const double share = ratio / (1 - ratio);
    Progress there = now_;
    for (std::size_t i = 0; i < last.contacts.size(); ++i) {
      const Vector3d ahead =
          now_.impulses.contacts[i] + share * (now_.impulses.contacts[i] - last.contacts[i]);
      there.impulses.contacts[i] =
          contacts::coulomb_projection(ahead, goal_.system.contacts[i].friction);
    }
    for (std::size_t i = 0; i < last.rows.size(); ++i)
      there.impulses.rows[i] += share * (now_.impulses.rows[i] - last.rows[i]);
    contacts::sum_impulses(goal_.system, there.impulses);
    goal_.measure(there);
    if (there.violation.squares < now_.violation.squares) now_ = std::move(there);
  }

  void soften(int rounds, double least_compliance) {
    double compliance = std::max(kFirstCompliance, least_compliance);
    Impulses second_last, last = now_.impulses;
    double lowest = std::numeric_limits<double>::infinity(), mark = lowest;
    for (int round = 0; round < rounds && !done(); ++round) {
      lowest = std::min({lowest, best_.violation.squares, now_.violation.squares});
      if (round % kPatience == kPatience - 1) {
        if (is_nearly_solved() && lowest > 0.5 * mark) return;
        mark = lowest;
      }
      if (round % kFinishEvery == 2) extrapolate(second_last, last);
      second_last = std::move(last);
      last = now_.impulses;
      const bool reached = contacts::soften(goal_, compliance, matrix_, now_);
      compliance =
          reached ? std::max(least_compliance, 0.3 * compliance) : std::min(1.0, 10 * compliance);
      if (now_.accepted || round % kFinishEvery == kFinishEvery - 1) try_to_finish();
    }
  }

  void follow() {
    for (double eps = kSoftest; eps > kHardest && !done(); eps *= kPathStep) {
      contacts::follow(goal_, eps, matrix_, now_);
      if (eps < kWorthFinishing) try_to_finish();
    }
  }

  const Goal& goal_;
  double enough_;
  contacts::Sweeper sweeper_;
  contacts::BodyMatrix& matrix_;
  Progress& now_;
  Progress best_;
};

void iterate(const Goal& goal, const ContactOptions& options, double enough, Progress& progress) {
  const std::size_t size = goal.system.contacts.size() + goal.system.rows.size();
  // one contact: the first sweep is exact
  if (static_cast<int>(size) > options.largest_direct || size == 1) {
    contacts::Sweeper sweeper(goal.system, kNegligible * goal.violation);
    sweep_until(goal, sweeper, options.most_sweeps_alone, progress);
    return;
  }
  contacts::BodyMatrix matrix(goal.system);
  Progress with_rows = progress;
  contacts::finish(goal, kFirstNewtonSteps, matrix, progress);
  if (progress.accepted || progress.violation.largest <= enough) return;
  // once more, from impulses of rows that go with those of the warm start
  with_rows.factorisations = progress.factorisations;
  if (contacts::hold_rows(goal, matrix, with_rows))
    contacts::finish(goal, kFirstNewtonSteps, matrix, with_rows);
  progress.factorisations = with_rows.factorisations;
  if (with_rows.violation.squares < progress.violation.squares) progress = with_rows;
  if (progress.accepted || progress.violation.largest <= enough) return;
  if (!contacts::stick(goal, matrix, progress))
    Turns(goal, enough, matrix, progress).run(options.most_sweeps);
}

/// Without the links that nothing touches. False: none could be left out, or what is left was not
/// solved well enough; then `progress` is as it was but for its counts.
bool solve_without_links(const contacts::LinkElimination& links, const Goal& goal,
                         const ContactOptions& options, double enough, Progress& progress) {
  if (!links.is_of_use()) return false;
  const Goal of_rest{links.rest(), goal.violation};
  Progress rest, whole;
  rest.impulses = links.of_rest(progress.impulses);
  of_rest.measure(rest);
  if (!rest.accepted) iterate(of_rest, options, enough, rest);
  whole.impulses = links.of_whole(rest.impulses);
  goal.measure(whole);
  if (!whole.accepted) {
    links.refine(whole.impulses);
    goal.measure(whole);
  }
  progress.sweeps = whole.sweeps = rest.sweeps;
  progress.factorisations = whole.factorisations = rest.factorisations;
  if (!whole.accepted && !(whole.violation.largest <= enough)) return false;
  progress = std::move(whole);
  return true;
}

/// What the answer leaves to errors becomes even; how well it solves the problem stays as measured.
LoadSharing spread_load(const std::optional<contacts::LinkElimination>& links, const Goal& goal,
                        double indistinct, Progress& progress) {
  if (!links || !links->is_of_use()) return contacts::spread(goal, indistinct, progress);
  const Goal of_rest{links->rest(), goal.violation};
  Progress rest;
  rest.impulses = links->of_rest(progress.impulses);
  const LoadSharing sharing = contacts::spread(of_rest, indistinct, rest);
  if (sharing == LoadSharing::kMostEven) {
    progress.impulses = links->of_whole(rest.impulses);
    links->refine(progress.impulses);
  }
  progress.sweeps += rest.sweeps;
  progress.factorisations += rest.factorisations;
  return sharing;
}

ContactSolution describe(const ContactProblem& problem, const System& system,
                         const Impulses& impulses) {
  ContactSolution solution;
  const std::size_t contacts = system.contacts.size();
  solution.impulses_world.reserve(contacts);
  solution.modes.reserve(contacts);
  for (std::size_t i = 0; i < contacts; ++i) {
    solution.impulses_world.push_back(system.contacts[i].contact_from_world.transpose() *
                                      impulses.contacts[i]);
    solution.modes.push_back(mode_of(system.contacts[i], impulses.contacts[i]));
  }
  solution.row_impulses = Eigen::Map<const VectorXd>(
      impulses.rows.data(), static_cast<Eigen::Index>(impulses.rows.size()));
  solution.velocities.reserve(problem.bodies.size());
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    const PushedBody& body = problem.bodies[i];
    solution.velocities.push_back(
        {body.velocity_world + system.root_inverse_mass[i] * impulses.y[i].head<3>(),
         body.omega_world + system.root_inverse_inertia[i] * impulses.y[i].tail<3>()});
  }
  return solution;
}

}  // namespace

ContactSolution solve_contacts(const ContactProblem& problem, const ContactOptions& options) {
  System system = contacts::build_system(problem);
  const double speed = system.speed > 0 ? system.speed : 1.0;
  const Goal goal{system, std::max(options.tolerance * speed, options.least_speed)};
  Progress progress;
  progress.impulses = contacts::warm_start_of(system, problem);
  const double enough = options.enough * speed;
  std::optional<contacts::LinkElimination> links;
  if (!system.rows.empty() && options.eliminates_links) {
    links.emplace(system, std::max(goal.violation, kHeldApproach * speed));
    for (const std::size_t i : links->held_contacts()) {
      contacts::leave_out(system.contacts[i]);
      progress.impulses.contacts[i].setZero();
    }
    if (!links->held_contacts().empty()) contacts::sum_impulses(system, progress.impulses);
  }
  if (!links || !solve_without_links(*links, goal, options, enough, progress)) {
    goal.measure(progress);
    if (!progress.accepted) iterate(goal, options, enough, progress);
  }
  LoadSharing sharing = LoadSharing::kStatics;
  if (options.indistinct > 0 && !system.rows.empty())
    sharing = spread_load(links, goal, options.indistinct, progress);
  ContactSolution solution = describe(problem, system, progress.impulses);
  solution.residual = progress.violation.largest / speed;
  solution.converged = progress.accepted;
  solution.sharing = sharing;
  solution.sweeps = progress.sweeps;
  solution.factorisations = progress.factorisations;
  return solution;
}

}  // namespace tumble
