// Whether bodies that are slow are at rest. From where they stand, all of them without velocity,
//   M u = h F(x, 0) + J^T p,     u / h: their acceleration,
// with the forces F that act on them beside contacts and the impulses p of contacts, friction, rods
// and joints that hold as much of that as they can. Drag and dampers do not act on what stands, so
// what creeps against them has an acceleration here, however slow it is.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/free_rotation.h"
#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/island_problems.h"
#include "framework/engines/contact/persistent_contacts.h"

namespace tumble::engines {
namespace {

// Of the grid's step: bodies are let go for so long. Stiff dampers, too, take little from what they
// gain in it; momenta begin at zero, so rounding does not ask for more.
constexpr double kLetGo = 1e-3;
// Of the largest acceleration: margins of 1e-10 of a body tilt what stands on several of them by
// some 1e-9.
constexpr double kHeld = 1e-8;
// residuals of a problem that the solver has left unsolved
constexpr double kResiduals = 10.0;
// Searches for a place of equilibrium: one direction takes two, by the secant.
constexpr int kMostSearches = 6;

double size_of(const Velocity& v, double radius) {
  return v.linear_world.norm() + radius * v.angular_world.norm();
}

}  // namespace

// Points that touch, or would after the bodies have moved by so much.
StepContacts PersistentContacts::contacts_at_rest(const ContactIsland& island,
                                                  const std::vector<RigidBodyState>& states,
                                                  double moved) const {
  StepContacts contacts;
  for (const Pair& pair : island.pairs) {
    double within =
        std::max(open_distance(pair), island.large ? 2 * geometry_.large_island_margin(pair) : 0.0);
    if (memory_.sharing.contains(pair))
      within = std::max(within, kContact.sharing_band * geometry_.size_of(pair));
    for (const collision::ManifoldPoint& point :
         geometry_.points_at(pair, states, within + 2 * moved))
      contacts.push_back({pair, point, 0.0, false, Vector3d::Zero(), point.gap});
  }
  return contacts;
}

PersistentContacts::Unheld PersistentContacts::unheld(const ContactIsland& island,
                                                      const std::vector<RigidBodyState>& states,
                                                      double moved) {
  const double h = kLetGo * step_;
  Unheld result;
  const std::vector<RigidBodyState> free = moving_.released(island.bodies, states, h);
  ContactProblem problem;
  BodyPlaces places;
  places.begin(moving_.size());
  const double t = moving_.time();
  double scale = moving_.world().gravity_world ? moving_.world().gravity_world->norm() : 0.0;
  for (const int body : island.bodies) {
    RigidBodyState at_start = free[body];  // its momenta there
    at_start.world_from_body = states[body].world_from_body;
    place_body(moving_, body, t, places, states, &at_start, problem);
    const PushedBody& pushed = problem.bodies.back();
    result.accelerations.push_back({pushed.velocity_world / h, pushed.omega_world / h});
    scale = std::max(scale,
                     size_of(result.accelerations.back(), moving_.shape(body).bounding_radius()));
  }
  result.unseen = kHeld * scale;
  // what hangs on links alone has been held by these
  if (!island.pairs.empty()) {
    const StepContacts contacts = contacts_at_rest(island, states, moved);
    add_contacts(moving_, geometry_, contacts, states, t, places, problem);
    warm_start_.set(contacts, states, h, kContact.warm_start_within_in_large_island, problem);
    add_island_rows(moving_, island, states, t, places, false, problem);
    ContactOptions options;
    if (island.large) {
      options.tolerance = kContact.solved_in_large_island;
      options.largest_direct = 0;
      options.most_sweeps_alone = kContact.sweeps_in_step;
    }
    const ContactSolution solution = solve_contacts(problem, options);
    if (!solution.converged)
      result.unseen = std::max(result.unseen, kResiduals * solution.residual * scale);
    for (std::size_t i = 0; i < island.bodies.size(); ++i)
      result.accelerations[i] = {solution.velocities[i].linear_world / h,
                                 solution.velocities[i].angular_world / h};
  }
  for (std::size_t i = 0; i < island.bodies.size(); ++i)
    result.largest = std::max(
        result.largest,
        size_of(result.accelerations[i], moving_.shape(island.bodies[i]).bounding_radius()));
  return result;
}

// Springs swing about their equilibrium without end, and what they draw through dampers comes to it
// ever slower: near enough is at rest. It is looked for along the acceleration, by the secant; what
// it does not lead to in a few rounds, as where a soft spring hangs on a stiff one, stays awake.
bool PersistentContacts::is_in_equilibrium(const ContactIsland& island, double within) {
  const RunCounters before = counters_;
  std::vector<RigidBodyState> states = moving_.states();
  bool found = false;
  double moved = 0.0;
  for (int search = 0; search < kMostSearches; ++search) {
    const Unheld here = unheld(island, states, moved);
    found = here.largest <= here.unseen;
    if (found || !std::isfinite(here.largest)) break;
    const auto at = [&](double way) {
      std::vector<RigidBodyState> there = states;
      for (std::size_t i = 0; i < island.bodies.size(); ++i) {
        RigidBodyState& state = there[island.bodies[i]];
        state.com_world += way / here.largest * here.accelerations[i].linear_world;
        state.world_from_body =
            turned(state.world_from_body, way / here.largest * here.accelerations[i].angular_world);
      }
      return there;
    };
    const auto along = [&](const Unheld& other) {
      double sum = 0.0;
      for (std::size_t i = 0; i < island.bodies.size(); ++i) {
        const double radius = moving_.shape(island.bodies[i]).bounding_radius();
        const auto &one = here.accelerations[i], &two = other.accelerations[i];
        sum += one.linear_world.dot(two.linear_world) +
               radius * radius * one.angular_world.dot(two.angular_world);
      }
      return sum;
    };
    const double left = within - moved, starts = along(here),
                 ends = along(unheld(island, at(left), moved + left));
    if (!(ends <= 0.0)) break;
    const double way = left * starts / (starts - ends);
    states = at(way);
    moved += way;
  }
  counters_ = before;
  return found;
}

}  // namespace tumble::engines
