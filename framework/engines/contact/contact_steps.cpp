// One step of an island in contact: its impulses, and the paths that they lead to. Part of
// PersistentContacts.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/persistent_contacts.h"

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

// Over a step of length h, which changes the velocities that the bodies would end with; with h = 0
// those that they have now. With `ends`, the places that contact will leave them in: there a free
// body's momenta would be other velocities, and impulses change momenta. Without that, a body that
// spins about its slender axis gains or loses energy in proportion to the step.
ContactProblem PersistentContacts::problem_of(const ContactIsland& island,
                                              const std::vector<StepContact>& contacts,
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
  for (const StepContact& step_contact : contacts) {
    PushingContact contact;
    contact.body_a = place_body(moving_, step_contact.pair.first, t, places_, states,
                                &states[step_contact.pair.first], problem);
    contact.body_b = place_body(moving_, step_contact.pair.second, t, places_, states,
                                &states[step_contact.pair.second], problem);
    contact.point_world = geometry_.point_of(step_contact.pair, step_contact.point);
    contact.normal_b_to_a_world = step_contact.point.normal_b_to_a_world;
    contact.friction = geometry_.friction(step_contact.pair);
    contact.target = step_contact.target;
    contact.slip_target_world = step_contact.slip_target_world;
    problem.contacts.push_back(contact);
  }
  if (!at_once)
    warm_start(
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
const std::vector<RigidBodyState>& PersistentContacts::middle_of_step(
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

// What an earlier attempt at this step has found for the pair, or else the last step.
const std::vector<KnownImpulse>* PersistentContacts::known_impulses(Pair pair) const {
  for (const auto* store : {&memory_.tried_impulses, &memory_.last_impulses})
    if (const auto known = store->find(pair); known != store->end()) return &known->second;
  return nullptr;
}

// Impulses that are known already, each to the point that is nearest to where it acted.
void PersistentContacts::warm_start(const std::vector<StepContact>& contacts,
                                    const std::vector<RigidBodyState>& states, double h,
                                    double farthest, ContactProblem& problem) const {
  for (std::size_t from = 0, to = 0; from < contacts.size(); from = to) {
    const Pair& pair = contacts[from].pair;
    while (to < contacts.size() && contacts[to].pair == pair) ++to;
    const std::vector<KnownImpulse>* const warm = known_impulses(pair);
    if (!warm) continue;
    const RigidBodyState& a = states[pair.first];
    const double size = geometry_.size_of(pair);
    for (const KnownImpulse& known : *warm) {
      const Vector3d acted = a.com_world + a.world_from_body * known.point_body_a;
      PushingContact* nearest = nullptr;
      double least = farthest * size;
      for (std::size_t i = from; i < to; ++i) {
        const double distance = (problem.contacts[i].point_world - acted).norm();
        if (distance >= least) continue;
        least = distance;
        nearest = &problem.contacts[i];
      }
      // A longer step needs more where the force lasts, no more where it was an impact.
      if (nearest)
        nearest->warm_start_world += std::min(1.0, h / known.duration) * known.impulse_world;
    }
  }
}

// Where rods and joints hold bodies still, all that is left of velocities is what places and
// multipliers are rounded by. [m/s]
double PersistentContacts::speed_of_rounding(const ContactIsland& island) const {
  double farthest = 0.0;
  for (const int body : island.bodies)
    farthest = std::max(
        farthest, moving_.state(body).com_world.norm() + moving_.shape(body).bounding_radius());
  return kCoordinateRounding * farthest / memory_.longest_step;
}

ContactSolution PersistentContacts::solve(const ContactIsland& island,
                                          const ContactProblem& problem, double h) {
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
    if (!problem.rows.empty()) options.least_speed = speed_of_rounding(island);
    // what stands has to be found to the last digit
    if (speed(island) > kContact.moving * restitution_threshold_) options.enough = kContact.solved;
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
      require_room(island, solution.residual);
    }
    return solution;
  }
  // The laws' part: A f + b are accelerations, f forces.
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

void PersistentContacts::note_unsolved(const ContactIsland& island, const ContactSolution& solution,
                                       double h) {
  const bool is_heap = island.large || (rules_.plastic_impacts == scene::PlasticImpacts::kInStep &&
                                        solution.impulses_world.size() > kContact.many_contacts);
  const double allowed = is_heap ? kContact.unsolved_in_large_island : kContactSolved;
  if (solution.converged || solution.residual <= allowed) return;
  unsolved_.note(RunWatch::Kind::kContactUnsolved, names_of(moving_.world(), island.bodies),
                 {solution.residual, allowed, moving_.time(), h});
}

void PersistentContacts::require_numbers(const ContactIsland& island,
                                         const ContactSolution& solution) const {
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    if (!solution.velocities[k].linear_world.allFinite() ||
        !solution.velocities[k].angular_world.allFinite())
      throw StoppedRun("persistent contact: the impulses on body '" +
                       moving_.world().bodies[island.bodies[k]].name + "' are not numbers");
}

// Puts a solution's impulses where the next problem of these pairs finds its warm start.
void PersistentContacts::remember(const std::vector<StepContact>& contacts,
                                  const ContactProblem& problem, const ContactSolution& solution,
                                  double h,
                                  std::map<Pair, std::vector<KnownImpulse>>& store) const {
  for (std::size_t from = 0, to = 0; from < contacts.size(); from = to) {
    const Pair& pair = contacts[from].pair;
    while (to < contacts.size() && contacts[to].pair == pair) ++to;
    std::vector<KnownImpulse>& known = store[pair];
    known.clear();
    known.reserve(to - from);
    const RigidBodyState& a = moving_.state(pair.first);
    for (std::size_t i = from; i < to; ++i)
      known.push_back(
          {a.world_from_body.conjugate() * (problem.contacts[i].point_world - a.com_world),
           solution.impulses_world[i], h});
  }
}

// What the next step remembers of this one's impulses.
void PersistentContacts::keep_warm_start(const ContactIsland& island,
                                         const std::vector<StepContact>& contacts,
                                         const ContactProblem& problem,
                                         const ContactSolution& solution, double h) {
  note_unsolved(island, solution, h);
  remember(contacts, problem, solution, h, next_impulses_);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vector3d force = solution.impulses_world[i] / h, point = problem.contacts[i].point_world;
    const bool slides =
        solution.modes[i] == ContactMode::kSlide && !force.isZero(0.0) &&
        slip_speed(problem, i, solution.velocities) > kCreep * restitution_threshold_;
    if (i == 0 || contacts[i].pair != contacts[i - 1].pair) next_stuck_.insert(contacts[i].pair);
    if (slides) next_stuck_.erase(contacts[i].pair);
    if (!force.isZero(0.0))
      forces_.push_back({contacts[i].pair.first, contacts[i].pair.second, point,
                         contacts[i].point.normal_b_to_a_world, force, solution.by_contact_forces});
  }
}

// Where a pair that slid and would stick at the end of the step stops sliding: when the friction
// that stops it is all there can be. What stops the slip is A + F s, with F the steady forces along
// it, the available friction M s; two steps of different lengths tell A and F. A pair that slides
// back at the end of the step has stopped within it, too: there its friction turns round.
std::optional<double> PersistentContacts::stop_of_sliding(const ContactProblem& problem,
                                                          const std::vector<StepContact>& contacts,
                                                          const ContactSolution& solution,
                                                          double h) {
  constexpr double kTurnsBack = 0.99;  // cosine: against the way that it slid, but for turning
  if (contacts.size() > kContact.few_contacts) return std::nullopt;
  const Pair* stopping = nullptr;
  double least = 1.0, stopping_impulse = 0.0, available = 0.0;
  double turns_back = 1.0;  // of the step: where the first pair does
  for (std::size_t i = 0; i < contacts.size();) {
    const Pair& pair = contacts[i].pair;
    Vector3d along = Vector3d::Zero();
    Vector3d slips = Vector3d::Zero(), slips_at_end = Vector3d::Zero();  // of the fastest point
    double limit = 0.0, slip = 0.0, speed = 0.0;
    bool sticks = true;
    for (; i < contacts.size() && contacts[i].pair == pair; ++i) {
      const PushingContact& c = problem.contacts[i];
      const Vector3d& n = c.normal_b_to_a_world;
      const auto velocity = [&](int body) -> Vector3d {
        const Body b = moving_.body_at_impact(body);
        const Vector3d arm = geometry_.point_of(pair, contacts[i].point) - b.com_world;
        if (!moving_.world().bodies[body].immovable())
          speed = std::max(speed, b.velocity_world.norm() + b.omega_world.norm() * arm.norm());
        return b.velocity_world + b.omega_world.cross(arm);
      };
      // at the step's start, where it touched then
      const Vector3d va = velocity(pair.first), vb = velocity(pair.second), relative = va - vb;
      if (const Vector3d slides = relative - relative.dot(n) * n; slides.norm() > slip) {
        slips = slides;
        slip = slides.norm();
        const Vector3d end =
            relative_velocity(problem, i, solution.velocities) - c.slip_target_world;
        slips_at_end = end - end.dot(n) * n;
      }
      speed = std::max({speed, va.norm(), vb.norm()});
      const double normal = solution.impulses_world[i].dot(n);
      along += solution.impulses_world[i] - normal * n;
      limit += c.friction * normal;
      // Points share what stops a pair: one may give all that it can, and others not.
      sticks = sticks &&
               (solution.modes[i] == ContactMode::kStick ||
                (solution.modes[i] == ContactMode::kOpen && normal == 0.0) ||
                (solution.modes[i] == ContactMode::kSlide &&
                 slip_speed(problem, i, solution.velocities) <= kCreep * restitution_threshold_));
    }
    // What friction stops within a billionth of the step has stopped.
    const double within_step = limit * (moving_.world().bodies[pair.first].inertia.inverse_mass +
                                        moving_.world().bodies[pair.second].inertia.inverse_mass);
    if (memory_.stuck.contains(pair) || !(limit > 0) || slip <= kNegligible * (speed + within_step))
      continue;
    // With the friction that brakes it, it would end by twice what friction gives more slowly.
    if (const double back = -slips_at_end.dot(slips) / slip;
        !sticks && back > kTurnsBack * slips_at_end.norm())
      turns_back = std::min(turns_back, slip / (slip + back + 2 * within_step));
    if (!sticks) continue;
    if (along.norm() >= least * limit) continue;
    least = along.norm() / limit;
    stopping = &pair;
    // signed: on a slope gravity may do more than stop it, and friction holds it then
    stopping_impulse = -along.dot(slips) / slip;
    available = limit;
  }
  if (!stopping && turns_back == 1.0) return std::nullopt;
  if (!(moving_.time() < memory_.searched_from + memory_.longest_step)) {
    memory_.searched_from = moving_.time();
    memory_.searches = 0;
  }
  if (++memory_.searches > kContact.most_searches) return std::nullopt;
  if (!stopping) {
    if (h <= kContact.shortest_step * memory_.longest_step) return std::nullopt;
    return moving_.time() + h * std::max(turns_back, kContact.soon);
  }
  if (memory_.sliding_search && memory_.sliding_search->pair == *stopping &&
      memory_.sliding_search->start == moving_.time()) {
    if (memory_.sliding_search->found) return std::nullopt;
    const double F = (memory_.sliding_search->impulse - stopping_impulse) /
                     (memory_.sliding_search->duration - h),
                 A = stopping_impulse - F * h, M = available / h;
    const double stop = A / (M - F);
    if (!(stop > kContact.shortest_step * memory_.longest_step) ||
        !(stop < memory_.sliding_search->duration))
      return std::nullopt;
    memory_.sliding_search->found = true;
    return moving_.time() + stop;
  }
  if (least >= 1 - kSolverResidue || h <= kContact.shortest_step * memory_.longest_step)
    return std::nullopt;
  memory_.sliding_search = SlidingSearch{*stopping, moving_.time(), h, stopping_impulse, false};
  return moving_.time() + h * std::max(least, kContact.soon);
}

// Does a contact become active in this step that did not touch before?
bool PersistentContacts::activates(const std::vector<StepContact>& contacts,
                                   const ContactSolution& solution) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].activates && solution.impulses_world[i].squaredNorm() > 0.0) return true;
  return false;
}

// Where the island's bodies come out with these impulses: ends_.
// @param inertia_at_ends  the problem took the inertia of the bodies where ends_ has had them so
// far; else at the end of their free paths
void PersistentContacts::find_ends(const ContactIsland& island, const ContactProblem& problem,
                                   const ContactSolution& solution, double h, bool activation,
                                   bool inertia_at_ends) {
  // the problem's first bodies are the island's
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    const Inertia& inertia = moving_.world().bodies[body].inertia;
    const Velocity& after = solution.velocities[k];
    RigidBodyState& end = ends_[body];
    if (activation) {
      const RigidBodyState& start = moving_.state(body);
      end.com_world = start.com_world + h * after.linear_world;
      end.world_from_body = turned(start.world_from_body, h * after.angular_world);
      end.angular_momentum_world =
          angular_momentum_of(after.angular_world, end.world_from_body, inertia);
    } else {
      const RigidBodyState& free = moving_.path_end(body);
      const Quaterniond at = inertia_at_ends ? end.world_from_body : free.world_from_body;
      const Vector3d turning = after.angular_world - problem.bodies[k].omega_world;
      end.com_world =
          free.com_world + 0.5 * h * (after.linear_world - problem.bodies[k].velocity_world);
      end.world_from_body = turned(free.world_from_body, 0.5 * h * turning);
      end.angular_momentum_world =
          free.angular_momentum_world + angular_momentum_of(turning, at, inertia);
    }
    end.momentum_world = inertia.mass * after.linear_world;
  }
}

// What contacts press the island's bodies with, its mean over the step: for the next step of those
// on which forces act that follow their motion. Where these bodies were not pressed in the step
// before, they are led anew by what has been found, until it stays the same.
// @return whether they have been: the step is taken again
bool PersistentContacts::finds_other_pressing(const ContactIsland& island,
                                              const std::vector<StepContact>& contacts,
                                              const ContactProblem& problem,
                                              const ContactSolution& solution, double h,
                                              bool inertia_at_ends) {
  std::map<int, Wrench> found;
  bool is_known = true, is_same = true;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const int body = island.bodies[k];
    if (!moving_.has_forces_of_motion(body)) continue;
    const Inertia& inertia = moving_.world().bodies[body].inertia;
    const RigidBodyState& at = inertia_at_ends ? ends_[body] : moving_.path_end(body);
    const Velocity& after = solution.velocities[k];
    const Wrench now{(inertia.mass / h) * (after.linear_world - problem.bodies[k].velocity_world),
                     angular_momentum_of(after.angular_world - problem.bodies[k].omega_world,
                                         at.world_from_body, inertia) /
                         h};
    found.emplace(body, now);
    is_known = is_known && memory_.pressing.contains(body);
    const auto felt = felt_.find(body);
    const Wrench before =
        felt == felt_.end() ? Wrench{Vector3d::Zero(), Vector3d::Zero()} : felt->second;
    const double largest = now.force_world.norm() * moving_.shape(body).bounding_radius() +
                           now.torque_world.norm();  // N m
    is_same = is_same &&
              (before.force_world - now.force_world).norm() <=
                  kContact.same_pressing * now.force_world.norm() &&
              (before.torque_world - now.torque_world).norm() <= kContact.same_pressing * largest;
  }
  if (found.empty()) return false;
  // what acts at a landing does not last
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].activates && !lasts(contacts[i].pair) &&
        !solution.impulses_world[i].isZero(0.0)) {
      for (const auto& [body, wrench] : found) next_pressing_.erase(body);
      return false;
    }
  const int first = island.bodies.front();
  const bool ends =
      is_known || is_same || ++pressing_rounds_[first] > 2 * kContact.most_pressing_rounds;
  if (!ends && pressing_rounds_[first] > kContact.most_pressing_rounds)
    found = limit_of_pressing(first, found);
  else if (!ends)
    pressing_changes_[first] = changes_of_pressing(found);
  // Of a very short step rounding makes forces of its own: what was known before stays.
  const bool is_told = h > kContact.shortest_step_for_pressing * memory_.longest_step;
  for (const auto& [body, wrench] : found) {
    felt_[body] = wrench;
    const auto before = memory_.pressing.find(body);
    if (is_told)
      next_pressing_[body] = wrench;
    else if (before != memory_.pressing.end())
      next_pressing_.insert(*before);
  }
  if (ends) return false;
  moving_.lead_pressed(found);
  return true;
}

std::map<int, Wrench> PersistentContacts::changes_of_pressing(
    const std::map<int, Wrench>& found) const {
  std::map<int, Wrench> changes;
  for (const auto& [body, wrench] : found) {
    Wrench change = wrench;
    if (const auto felt = felt_.find(body); felt != felt_.end()) {
      change.force_world -= felt->second.force_world;
      change.torque_world -= felt->second.torque_world;
    }
    changes.emplace(body, change);
  }
  return changes;
}

// Where forces take most of a motion within the step, each round leaves a part rho near 1 of the
// change d of the last one: then d + rho d + rho^2 d + ... = d / (1 - rho) is left (Aitken), which
// two rounds in a row tell.
std::map<int, Wrench> PersistentContacts::limit_of_pressing(int first,
                                                            const std::map<int, Wrench>& found) {
  constexpr double kSlowest = 0.999;  // of rho: what is slower is no sequence that ends
  const std::map<int, Wrench> changes = changes_of_pressing(found);
  const std::map<int, Wrench> before = std::exchange(pressing_changes_[first], changes);
  double along = 0.0, square = 0.0;  // (N m)^2
  for (const auto& [body, change] : changes) {
    const auto last = before.find(body);
    if (last == before.end()) return found;
    const double size = std::pow(moving_.shape(body).bounding_radius(), 2);
    along += size * change.force_world.dot(last->second.force_world) +
             change.torque_world.dot(last->second.torque_world);
    square +=
        size * last->second.force_world.squaredNorm() + last->second.torque_world.squaredNorm();
  }
  const double rho = square > 0.0 ? along / square : 0.0;
  if (!(rho < kSlowest)) return found;
  pressing_changes_[first].clear();  // two plain rounds tell the next
  std::map<int, Wrench> limit = found;
  for (auto& [body, wrench] : limit) {
    wrench.force_world += rho / (1.0 - rho) * changes.at(body).force_world;
    wrench.torque_world += rho / (1.0 - rho) * changes.at(body).torque_world;
  }
  return limit;
}

// The angle that the fastest of the island's bodies turns in the step; a ball looks the same
// however it turns.
double PersistentContacts::largest_turn(const ContactIsland& island,
                                        const std::vector<RigidBodyState>& ends, double h) const {
  double turn = 0.0;
  for (const int body : island.bodies)
    if (!moving_.shape(body).is_ball())
      turn = std::max(turn, omega_of(ends[body], moving_.world().bodies[body].inertia).norm() * h);
  return turn;
}

// The angle that the normal between two balls turns most in the step: the one that slides or rolls
// on the other follows its curve.
double PersistentContacts::turn_of_normals(const ContactIsland& island,
                                           const std::vector<RigidBodyState>& ends) const {
  double turn = 0.0;
  for (const Pair& pair : island.pairs) {
    if (!geometry_.are_balls(pair) || points_.at(pair).empty()) continue;
    const auto end = [&](int body) -> Vector3d {
      return moving_.world().bodies[body].immovable()
                 ? prescribed_position(moving_.world().bodies[body], moving_.target())
                 : ends[body].com_world;
    };
    const Vector3d start =
                       moving_.state(pair.first).com_world - moving_.state(pair.second).com_world,
                   stop = end(pair.first) - end(pair.second);
    turn = std::max(turn, std::atan2(start.cross(stop).norm(), start.dot(stop)));
  }
  return turn;
}

// Contacts of an island that turns: at the middle of the step, where their forces act evenly, with
// targets that make the velocities at the step's end fit the surfaces there: J_middle v' = target -
// (J_end - J_middle) v'. Without that a body that tips over its edge gains or loses energy in
// proportion to the step.
std::vector<PersistentContacts::StepContact> PersistentContacts::contacts_midway(
    const ContactIsland& island, const std::vector<StepContact>& contacts) {
  const std::vector<RigidBodyState>& starts = moving_.states();
  const std::vector<RigidBodyState>& ends = ends_;
  std::vector<RigidBodyState>& middle = midway_;
  for (const int body : island.bodies) {
    middle[body].com_world = 0.5 * (starts[body].com_world + ends[body].com_world);
    middle[body].world_from_body =
        starts[body].world_from_body.slerp(0.5, ends[body].world_from_body);
  }
  const auto slip = [&](Pair pair, const std::vector<RigidBodyState>& at,
                        const collision::ManifoldPoint& p) -> Vector3d {
    const Vector3d point = geometry_.point_of(pair, p);
    const auto velocity = [&](int body) -> Vector3d {
      const WorldBody& b = moving_.world().bodies[body];
      if (b.immovable()) return prescribed_velocity(b, moving_.target());
      return b.inertia.inverse_mass * ends[body].momentum_world +
             omega_of(ends[body], b.inertia).cross(point - at[body].com_world);
    };
    return velocity(pair.first) - velocity(pair.second);
  };
  std::vector<StepContact> result;
  std::size_t from = 0;
  for (const Pair& pair : island.pairs) {
    std::size_t to = from;
    while (to < contacts.size() && contacts[to].pair == pair) ++to;
    if (to == from) continue;
    double farthest = 0.0;  // no point of the contact can be farther off by the step's end
    for (std::size_t i = from; i < to; ++i)
      farthest = std::max({farthest, contacts[i].start_gap, contacts[i].point.gap});
    for (const int body : {pair.first, pair.second})
      farthest +=
          (ends[body].com_world - starts[body].com_world).norm() +
          (moving_.shape(body).is_half_space()
               ? 0.0
               : moving_.shape(body).bounding_radius() *
                     starts[body].world_from_body.angularDistance(ends[body].world_from_body));
    const double near = geometry_.same_within(pair),
                 reach = geometry_.are_balls(pair)
                             ? geometry_.size_of(pair)
                             : std::min(near, farthest + geometry_.margin(pair));
    const ContactManifold at_middle = geometry_.points_at(pair, middle, reach),
                          at_end = geometry_.points_at(pair, ends, reach);
    for (std::size_t i = from; i < to; ++i) {
      StepContact step_contact = contacts[i];
      const collision::ManifoldPoint* mid =
          geometry_.same_point(pair, step_contact.point, starts, at_middle, middle, near);
      const collision::ManifoldPoint* end =
          mid ? geometry_.same_point(pair, *mid, middle, at_end, ends, near) : nullptr;
      if (mid && end) {
        step_contact.point = *mid;
        const Vector3d at_end_point = slip(pair, ends, *end),
                       at_mid_point = slip(pair, middle, *mid);
        step_contact.target -=
            end->normal_b_to_a_world.dot(at_end_point) - mid->normal_b_to_a_world.dot(at_mid_point);
        step_contact.slip_target_world = at_mid_point - at_end_point;
      }
      result.push_back(step_contact);
    }
    from = to;
  }
  return result;
}

// @return whether no overlap was left
bool PersistentContacts::set_paths(const ContactIsland& island,
                                   const std::vector<StepContact>& contacts,
                                   const std::vector<RigidBodyState>& contacts_at,
                                   const ContactProblem& problem, const ContactSolution& solution,
                                   double h, bool activation) {
  const bool is_midway = &contacts_at == &midway_;
  find_ends(island, problem, solution, h, activation, is_midway);
  std::vector<ActiveContact> active;  // where nothing turns, points stay as near as they are
  if (is_midway && !activation && contacts.size() <= kContact.many_contacts)
    for (std::size_t i = 0; i < contacts.size(); ++i)
      if (contacts[i].start_gap < kContact.far_at_start * geometry_.margin(contacts[i].pair) &&
          solution.impulses_world[i].squaredNorm() > 0.0)
        active.push_back({contacts[i].pair, contacts[i].point, &contacts_at});
  // Pairs that are not in contact may meet within the step: that is for the finding of impacts.
  const bool apart =
      correction_.correct_positions(island, island.pairs, ends_, moving_.target(), active);
  for (const int body : moving_.driven_bodies()) ends_[body] = moving_.state(body);
  // The path goes where position correction has moved its end, however short the step: velocities
  // along it are no momenta. What rods and joints hold is put right where a step ends within it
  // (MovingWorld::commit).
  for (const int body : island.bodies) {
    if (activation)
      set_straight_path(body, ends_[body]);
    else
      moving_.set_path(body, moving_.state(body), ends_[body], SmoothPath::Momenta::kEven);
    moving_.refuse_fast_turning(body);
  }
  return apart;
}

// From place to place, as x' = x + h v' says: a bent path would dip below the surface on its way.
void PersistentContacts::set_straight_path(int body, const RigidBodyState& end) {
  const Inertia& inertia = moving_.world().bodies[body].inertia;
  RigidBodyState start = moving_.state(body);
  start.momentum_world = end.momentum_world;
  start.angular_momentum_world =
      angular_momentum_of(omega_of(end, inertia), start.world_from_body, inertia);
  moving_.set_path(body, start, end, SmoothPath::Momenta::kEven);
}

}  // namespace tumble::engines
