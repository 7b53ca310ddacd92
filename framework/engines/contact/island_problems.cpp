#include "framework/engines/contact/island_problems.h"

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"

namespace tumble::engines {
namespace {

// Nothing touches.
ContactSolution unpushed(const ContactProblem& problem) {
  ContactSolution solution;
  for (const PushedBody& body : problem.bodies)
    solution.velocities.push_back({body.velocity_world, body.omega_world});
  solution.converged = true;
  return solution;
}

Vector3d velocity_at(const PushedBody& body, const Vector3d& velocity, const Vector3d& omega,
                     const Vector3d& point) {
  return velocity + omega.cross(point - body.com_world);
}

}  // namespace

void add_contacts(const MovingWorld& moving, const ContactGeometry& geometry,
                  const StepContacts& contacts, const std::vector<RigidBodyState>& states, double t,
                  BodyPlaces& places, ContactProblem& problem) {
  for (const StepContact& step_contact : contacts) {
    PushingContact contact;
    contact.body_a = place_body(moving, step_contact.pair.first, t, places, states,
                                &states[step_contact.pair.first], problem);
    contact.body_b = place_body(moving, step_contact.pair.second, t, places, states,
                                &states[step_contact.pair.second], problem);
    contact.point_world = geometry.point_of(step_contact.pair, step_contact.point);
    contact.normal_b_to_a_world = step_contact.point.normal_b_to_a_world;
    contact.friction = geometry.friction(step_contact.pair);
    contact.target = step_contact.target;
    contact.slip_target_world = step_contact.slip_target_world;
    problem.contacts.push_back(contact);
  }
}

ContactProblem IslandProblems::of(const ContactIsland& island, const StepContacts& contacts,
                                  const std::vector<RigidBodyState>& states, double h,
                                  const std::vector<RigidBodyState>* ends) {
  ContactProblem problem;
  places_.begin(moving_.size());
  const bool at_once = h == 0.0;
  const double t = at_once ? moving_.time() : moving_.target();
  for (const int body : island.bodies) {
    RigidBodyState free = at_once ? states[body] : moving_.path_end(body);
    if (ends) free.world_from_body = (*ends)[body].world_from_body;
    place_body(moving_, body, t, places_, states, &free, problem);
  }
  add_contacts(moving_, geometry_, contacts, states, t, places_, problem);
  if (!at_once)
    warm_start_.set(
        contacts, states, h,
        island.large ? kContact.warm_start_within_in_large_island : kContact.warm_start_within,
        problem);
  if (at_once || island.linked.empty())
    add_island_rows(moving_, island, moving_.states(), moving_.time(), places_, false, problem);
  else
    add_island_rows(moving_, island, middle_of_step(island, ends), moving_.time() + 0.5 * h,
                    places_, false, problem);
  return problem;
}

// Rods and joints react to what pushes over a step along the directions that they have in its
// middle: with those of its start a body on a rod that is pressed to a floor would turn a part of
// that pressure, in proportion to the step, into energy.
const std::vector<RigidBodyState>& IslandProblems::middle_of_step(
    const ContactIsland& island, const std::vector<RigidBodyState>* ends) {
  middle_.resize(moving_.states().size());
  for (const int body : island.bodies) {
    const RigidBodyState &from = moving_.state(body),
                         &to = ends ? (*ends)[body] : moving_.path_end(body);
    middle_[body] = {0.5 * (from.com_world + to.com_world),
                     from.world_from_body.slerp(0.5, to.world_from_body),
                     0.5 * (from.momentum_world + to.momentum_world),
                     0.5 * (from.angular_momentum_world + to.angular_momentum_world)};
  }
  return middle_;
}

// Where rods and joints hold bodies still, all that is left of velocities is what places and
// multipliers are rounded by. [m/s]
double IslandProblems::speed_of_rounding(const ContactIsland& island) const {
  double farthest = 0.0;
  for (const int body : island.bodies)
    farthest = std::max(
        farthest, moving_.state(body).com_world.norm() + moving_.shape(body).bounding_radius());
  return kCoordinateRounding * farthest / memory_.longest_step;
}

double IslandProblems::indistinct_speed(const ContactIsland& island) const {
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& pair : island.pairs) smallest = std::min(smallest, geometry_.size_of(pair));
  const double h = moving_.target() - moving_.time();
  return kSixDigits * (smallest / h + fastest_speed(moving_, island));
}

ContactSolution IslandProblems::solve(const ContactIsland& island, const ContactProblem& problem,
                                      double h) {
  if (problem.contacts.empty() && problem.rows.empty()) return unpushed(problem);
  ++counters_.contact_solves;
  counters_.contact_points += problem.contacts.size();
  const auto smooth = [](const PushingContact& c) { return c.friction == 0.0; };
  const bool frictionless = std::all_of(problem.contacts.begin(), problem.contacts.end(), smooth);
  if (!frictionless)
    counters_.friction_points +=
        static_cast<std::uint64_t>(std::count_if(problem.contacts.begin(), problem.contacts.end(),
                                                 [&](const auto& c) { return !smooth(c); }));
  if (!frictionless || !problem.rows.empty() || problem.contacts.size() > kContact.many_contacts) {
    ContactOptions options;
    if (problem.contacts.size() > kContact.few_contacts) options.tolerance = kContact.solved;
    if (!problem.rows.empty()) {
      options.least_speed = speed_of_rounding(island);
      options.indistinct = indistinct_speed(island);
    }
    // what stands has to be found to the last digit
    if (fastest_speed(moving_, island) > kContact.moving * restitution_threshold_)
      options.enough = kContact.solved;
    if (rules_.plastic_impacts == scene::PlasticImpacts::kInStep &&
        problem.contacts.size() > kContact.many_contacts) {
      options.tolerance = kContact.solved_in_large_island;
      options.largest_direct = 0;
      options.most_sweeps_alone = kContact.sweeps_in_step;
    }
    ContactSolution solution = laws_.friction_impulses ? laws_.friction_impulses(problem, options)
                                                       : solve_contacts(problem, options);
    // a warm start can mislead: once more from zero, with every means
    if (!laws_.friction_impulses && !solution.converged && solution.residual > kContactSolved) {
      ContactProblem afresh = problem;
      for (PushingContact& contact : afresh.contacts) contact.warm_start_world.setZero();
      ContactOptions every;
      every.tolerance = options.tolerance;
      every.least_speed = options.least_speed;
      ContactSolution again = solve_contacts(afresh, every);
      again.sweeps += solution.sweeps;
      again.factorisations += solution.factorisations;
      if (again.residual < solution.residual) solution = std::move(again);
    }
    counters_.contact_sweeps += static_cast<std::uint64_t>(solution.sweeps);
    memory_.sweeps += static_cast<std::uint64_t>(solution.sweeps);
    counters_.contact_factorisations += static_cast<std::uint64_t>(solution.factorisations);
    if (!solution.converged) {
      ++counters_.contact_unsolved;
      progress_.require_room(island, solution.residual);
    }
    return solution;
  }
  return solve_by_laws(island, problem, h);
}

// The laws' part: A f + b are accelerations, f forces.
ContactSolution IslandProblems::solve_by_laws(const ContactIsland& island,
                                              const ContactProblem& problem, double h) const {
  const Eigen::Index m = static_cast<Eigen::Index>(problem.contacts.size()),
                     n = 6 * static_cast<Eigen::Index>(problem.bodies.size());
  MatrixXd J = MatrixXd::Zero(m, n), MJ = MatrixXd::Zero(n, m);
  VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const PushingContact& c = problem.contacts[i];
    double rate = 0.0;
    for (const auto& [index, sign] : {std::pair{c.body_a, 1.0}, std::pair{c.body_b, -1.0}}) {
      const PushedBody& body = problem.bodies[index];
      const Vector3d push = sign * c.normal_b_to_a_world,
                     turn = (c.point_world - body.com_world).cross(push);
      J.block<1, 3>(i, 6 * index) = push.transpose();
      J.block<1, 3>(i, 6 * index + 3) = turn.transpose();
      MJ.block<3, 1>(6 * index, i) = body.inverse_mass * push;
      MJ.block<3, 1>(6 * index + 3, i) = body.inverse_inertia_world * turn;
      rate += push.dot(velocity_at(body, body.velocity_world, body.omega_world, c.point_world));
    }
    b[i] = (rate - c.target) / h;
  }
  const VectorXd f = naming(
      "body '" + moving_.world().bodies[island.bodies.front()].name + "' and what it touches",
      [&] { return laws_.contact_forces(J * MJ, b); });
  if (f.size() != m)
    throw StoppedRun("persistent contact (contact_forces of " + laws_.source_of_contacts() +
                     ") returned " + std::to_string(f.size()) + " forces for " + std::to_string(m) +
                     " points");
  const VectorXd change = MJ * (h * f);
  ContactSolution solution;
  for (Eigen::Index i = 0; i < m; ++i) {
    solution.impulses_world.push_back(h * f[i] * problem.contacts[i].normal_b_to_a_world);
    solution.modes.push_back(f[i] > 0 ? ContactMode::kSlide : ContactMode::kOpen);
  }
  for (std::size_t k = 0; k < problem.bodies.size(); ++k)
    solution.velocities.push_back(
        {problem.bodies[k].velocity_world + change.segment<3>(6 * static_cast<Eigen::Index>(k)),
         problem.bodies[k].omega_world + change.segment<3>(6 * static_cast<Eigen::Index>(k) + 3)});
  solution.converged = true;
  solution.by_contact_forces = true;
  return solution;
}

ContactSolution IslandProblems::solve_large(const ContactProblem& problem) {
  const bool located = rules_.plastic_impacts != scene::PlasticImpacts::kInStep;
  ContactOptions options;
  options.tolerance = kContact.solved_in_large_island;
  options.least_speed = kContact.still * restitution_threshold_;
  options.most_sweeps_alone = kContact.sweeps_in_large_island;
  if (located) {  // the scene does not ask for steps: their problems are solved at least
    options.enough = kContact.solved_in_large_island;
    options.most_sweeps = kContact.sweeps_in_large_island;
  } else {
    options.largest_direct = 0;
  }
  ++counters_.contact_solves;
  counters_.contact_points += problem.contacts.size();
  ContactSolution solution = laws_.friction_impulses ? laws_.friction_impulses(problem, options)
                                                     : solve_contacts(problem, options);
  counters_.contact_sweeps += static_cast<std::uint64_t>(solution.sweeps);
  counters_.contact_factorisations += static_cast<std::uint64_t>(solution.factorisations);
  if (!solution.converged) ++counters_.contact_unsolved;
  return solution;
}

void IslandProblems::note_unsolved(const ContactIsland& island, const ContactSolution& solution,
                                   double h) {
  const bool is_heap = island.large || (rules_.plastic_impacts == scene::PlasticImpacts::kInStep &&
                                        solution.impulses_world.size() > kContact.many_contacts);
  const double allowed = is_heap ? kContact.unsolved_in_large_island : kContactSolved;
  if (solution.converged || solution.residual <= allowed) return;
  unsolved_.note(RunWatch::Kind::kContactUnsolved, names_of(moving_.world(), island.bodies),
                 {solution.residual, allowed, moving_.time(), h});
}

void IslandProblems::say_undecided(const ContactIsland& island, const ContactSolution& solution) {
  if (solution.sharing != LoadSharing::kUndecided) return;
  const std::string names = names_of(moving_.world(), island.bodies);
  unsolved_.say(
      "undecided loads", moving_.time(),
      fmt::format("which contacts carry {} is not decided from {:.4g} s on: rods or joints leave "
                  "several ways, and no most even one was found. Friction goes with the load, so "
                  "their motion may hang on the step. Compare with half the step; springs in place "
                  "of rods or joints, or fewer points that touch, decide it",
                  names, moving_.time()));
}

void IslandProblems::require_numbers(const ContactIsland& island,
                                     const ContactSolution& solution) const {
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    if (!solution.velocities[k].linear_world.allFinite() ||
        !solution.velocities[k].angular_world.allFinite())
      throw StoppedRun("persistent contact: the impulses on body '" +
                       moving_.world().bodies[island.bodies[k]].name + "' are not numbers");
}

}  // namespace tumble::engines
