#include "framework/engines/stepping/linked_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/dynamics/split_ode.h"
#include "framework/dynamics/state_units.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {

double path_bend(const Laws& laws) {
  constexpr int kHeight = 0, kSpeed = 1;
  const OdeFunction fall = [](double, const VectorXd& y) {
    VectorXd dy(2);
    dy << y[kSpeed], 1.0;
    return dy;
  };
  try {
    return 2.0 * laws.integrate_step(fall, 0.0, VectorXd::Zero(2), 1.0)[kHeight];
  } catch (const StoppedRun&) {
    return 1.0;  // the first step of a body fails in the same way, and names the body
  }
}

namespace {

Body body_of(const RigidBodyState& state, const Inertia& inertia) {
  return {inertia, state.com_world, state.world_from_body.normalized(),
          inertia.inverse_mass * state.momentum_world, omega_of(state, inertia)};
}

void add_force(const Body& body, const Vector3d& force, const Vector3d& point, Wrench& wrench) {
  wrench.force_world += force;
  wrench.torque_world += (point - body.com_world).cross(force);
}

}  // namespace

LinkedBodies::LinkedBodies(const World& world, const Laws& laws, RunCounters& counters,
                           OuterWrench outer_wrench, LinkedGroup group, LeftAlone left_alone)
    : world_(world),
      laws_(laws),
      counters_(counters),
      outer_wrench_(std::move(outer_wrench)),
      left_alone_(std::move(left_alone)),
      bodies_(std::move(group.bodies)) {
  for (const auto& [k, entries] : group.entries) {
    auto acting =
        effects::all()[k]->group_terms({world_, laws_, counters_.effect_calls[k]}, entries, *this);
    if (!acting) continue;
    row_count_ += acting->row_count();
    if (acting->control() != nullptr) controls_.push_back(terms_.size());
    terms_.push_back({k, std::move(acting)});
  }
  has_loop_ = closes_loop(group);
  has_small_loop_ = has_loop_ && row_count_ <= kMostDenseRows;
  length_ = length_of_units();
  units_.resize(static_cast<Eigen::Index>(bodies_.size()) * kStateSize);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    units_.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize) =
        units_of_state(world_.bodies[bodies_[i]].inertia, length_);
  if (world_.coordinates == scene::Coordinates::kReduced) plant_tree();
}

bool LinkedBodies::has_forces_of_motion() const {
  return std::any_of(terms_.begin(), terms_.end(), [](const Terms& terms) {
    return terms.acting->row_count() == 0 && terms.acting->control() == nullptr;
  });
}

// What links the group says how large it is, and the bodies do. The radius of gyration of a point
// mass is no size: it counts where there is nothing else.
double LinkedBodies::length_of_units() const {
  double length = 0.0, of_points = 0.0;
  for (const Terms& terms : terms_) length = std::max(length, terms.acting->reach());
  for (const int index : bodies_) {
    const WorldBody& body = world_.bodies[static_cast<std::size_t>(index)];
    double& largest = body.has_no_size ? of_points : length;
    largest = std::max(largest, radius_of_gyration(body.inertia));
  }
  return length > 0.0 ? length : of_points;
}

bool LinkedBodies::has(int body) const {
  return std::binary_search(bodies_.begin(), bodies_.end(), body);
}

int LinkedBodies::place_of(int body) {
  const auto found = std::lower_bound(bodies_.begin(), bodies_.end(), body);
  if (found != bodies_.end() && *found == body) return static_cast<int>(found - bodies_.begin());
  auto fixed = std::find(fixed_.begin(), fixed_.end(), body);
  if (fixed == fixed_.end()) fixed = fixed_.insert(fixed_.end(), body);
  return static_cast<int>(bodies_.size() + static_cast<std::size_t>(fixed - fixed_.begin()));
}

std::vector<RigidBodyState> LinkedBodies::take(const std::vector<RigidBodyState>& states) const {
  std::vector<RigidBodyState> local;
  local.reserve(bodies_.size());
  for (const int body : bodies_) local.push_back(states[body]);
  return local;
}

void LinkedBodies::put(const std::vector<RigidBodyState>& local,
                       std::vector<RigidBodyState>& states) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) states[bodies_[i]] = local[i];
}

std::vector<Body> LinkedBodies::place_bodies(const std::vector<RigidBodyState>& local,
                                             double t) const {
  std::vector<Body> bodies;
  bodies.reserve(bodies_.size() + fixed_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    bodies.push_back(body_of(local[i], world_.bodies[bodies_[i]].inertia));
  for (const int fixed : fixed_) {
    Body body{infinite_inertia(), Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
              Vector3d::Zero()};
    if (fixed >= 0) {
      body.com_world = prescribed_position(world_.bodies[fixed], t);
      body.velocity_world = prescribed_velocity(world_.bodies[fixed], t);
      body.world_from_body = world_.bodies[fixed].state.world_from_body;
    }
    bodies.push_back(body);
  }
  return bodies;
}

// Of everything but rods and joints.
std::vector<Wrench> LinkedBodies::forces(const std::vector<RigidBodyState>& local,
                                         const std::vector<Body>& bodies) {
  const StageTimer timer(counters_.force_seconds);
  std::vector<Wrench> wrenches(bodies.size(), {Vector3d::Zero(), Vector3d::Zero()});
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    wrenches[i] = outer_wrench_(bodies_[i], local[i]);
  for (const Terms& terms : terms_) terms.acting->add_forces(bodies, wrenches);
  return wrenches;
}

double LinkedBodies::look(double time, const std::vector<RigidBodyState>& states) {
  double next = std::numeric_limits<double>::infinity();
  if (controls_.empty()) return next;
  const StageTimer timer(counters_.control_seconds);
  const std::vector<Body> bodies = place_bodies(take(states), time);
  for (const std::size_t k : controls_)
    next = std::min(next, terms_[k].acting->control()->look(time, bodies));
  return next;
}

std::map<int, effects::Memory> LinkedBodies::held() const {
  std::map<int, effects::Memory> all;
  for (const std::size_t k : controls_)
    all.emplace(static_cast<int>(terms_[k].effect), terms_[k].acting->control()->memory());
  return all;
}

void LinkedBodies::remember(const std::map<int, effects::Memory>& held) {
  static const effects::Memory none;
  for (const std::size_t k : controls_) {
    const auto found = held.find(static_cast<int>(terms_[k].effect));
    terms_[k].acting->control()->remember(found == held.end() ? none : found->second);
  }
}

void LinkedBodies::look_again() {
  for (const std::size_t k : controls_) terms_[k].acting->control()->look_again();
}

bool LinkedBodies::is_driven_otherwise(const std::map<int, effects::Memory>& before) const {
  return std::any_of(controls_.begin(), controls_.end(), [&](std::size_t k) {
    return terms_[k].acting->control()->differs_from(before.at(static_cast<int>(terms_[k].effect)));
  });
}

std::vector<Constraint> LinkedBodies::rows(const std::vector<Body>& bodies) {
  std::vector<Constraint> rows;
  rows.reserve(row_count_);
  for (const Terms& terms : terms_) terms.acting->append_rows(bodies, rows);
  return rows;
}

void add_rows(LinkedBodies& group, const std::vector<RigidBodyState>& states, double t,
              const BodyPlaces& places, ContactProblem& problem) {
  const int fixed = static_cast<int>(problem.bodies.size());
  bool uses_fixed = false;
  std::vector<Constraint> rows = group.constraint_rows(states, t);
  problem.rows.reserve(problem.rows.size() + rows.size());
  for (Constraint& row : rows) {
    for (int* const body : {&row.body_a, &row.body_b}) {
      uses_fixed = uses_fixed || *body >= group.fixed_end();
      *body = *body < group.fixed_end() ? places.at(group.bodies()[static_cast<std::size_t>(*body)])
                                        : fixed;
    }
    problem.rows.push_back(row);
  }
  if (uses_fixed)
    problem.bodies.push_back(
        {0.0, Matrix3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()});
}

void keep_rates(ContactProblem& problem) {
  const auto rate = [&](int body, const Vector6d& jacobian) {
    const PushedBody& pushed = problem.bodies[static_cast<std::size_t>(body)];
    return jacobian.head<3>().dot(pushed.velocity_world) +
           jacobian.tail<3>().dot(pushed.omega_world);
  };
  problem.row_targets.resize(static_cast<Eigen::Index>(problem.rows.size()));
  for (std::size_t k = 0; k < problem.rows.size(); ++k) {
    const auto& [a, b, row] = problem.rows[k];
    problem.row_targets[static_cast<Eigen::Index>(k)] =
        rate(a, row.jacobian_a) + rate(b, row.jacobian_b);
  }
}

Vector3d LinkedBodies::acceleration_of_fixed(int fixed, const Vector3d& com_world, double t) const {
  const WorldBody& body = world_.bodies[static_cast<std::size_t>(fixed)];
  const double w = body.motion.angular_frequency_rad_s;
  if (w == 0.0) return Vector3d::Zero();
  return -w * w * (com_world - body.com_at_0_world - body.motion.velocity_m_s * t);
}

VectorXd LinkedBodies::add_constraint_forces(const std::vector<Constraint>& all,
                                             const std::vector<Body>& bodies,
                                             const std::vector<RigidBodyState>& local,
                                             std::vector<Wrench>& wrenches) {
  const StageTimer timer(counters_.constraint_seconds);
  std::vector<ConstrainedBody> held = constrained(bodies);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    ConstrainedBody& body = held[i];
    if (i < bodies_.size()) {
      const Vector3d gyroscopic = bodies[i].omega_world.cross(local[i].angular_momentum_world);
      body.free_acceleration << body.inverse_mass * wrenches[i].force_world,
          body.inverse_inertia_world * (wrenches[i].torque_world - gyroscopic);
    } else if (fixed_[i - bodies_.size()] >= 0) {
      // a shaken end accelerates
      body.free_acceleration.head<3>() =
          acceleration_of_fixed(fixed_[i - bodies_.size()], bodies[i].com_world, time_of_stage_);
    }
  }
  VectorXd wanted = VectorXd::Zero(static_cast<Eigen::Index>(all.size()));
  if (world_.stabilisation && world_.stabilisation->kind == scene::StabilisationKind::kBaumgarte)
    for (std::size_t k = 0; k < all.size(); ++k)
      wanted[static_cast<Eigen::Index>(k)] = laws_.baumgarte_acceleration(
          all[k].row.value, all[k].row.rate, world_.stabilisation->time_constant_s);
  ++counters_.constraint_solves;
  const VectorXd multipliers = laws_.constraint_multipliers(all, held, wanted);
  if (multipliers.size() != wanted.size())
    throw StoppedRun("rods and joints (constraint_multipliers of " + laws_.source_of_links() +
                     ") returned " + std::to_string(multipliers.size()) + " multipliers for " +
                     std::to_string(wanted.size()) + " constraints");
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double lambda = multipliers[static_cast<Eigen::Index>(k)];
    const auto& [a, b, row] = all[k];
    wrenches[a].force_world += lambda * row.jacobian_a.head<3>();
    wrenches[a].torque_world += lambda * row.jacobian_a.tail<3>();
    wrenches[b].force_world += lambda * row.jacobian_b.head<3>();
    wrenches[b].torque_world += lambda * row.jacobian_b.tail<3>();
  }
  return multipliers;
}

namespace {

// Of packed bodies.
RigidBodyState stage_of(const VectorXd& y, std::size_t body) {
  RigidBodyState state =
      unpack(y.segment(static_cast<Eigen::Index>(body) * kStateSize, kStateSize));
  state.world_from_body.normalize();  // why: MovingWorld::integrate
  return state;
}

}  // namespace

VectorXd LinkedBodies::derivative(double t, const VectorXd& y) {
  ++counters_.derivative_evaluations;
  std::vector<RigidBodyState> local;
  local.reserve(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) local.push_back(stage_of(y, i));
  time_of_stage_ = t;
  const std::vector<Body> bodies = place_bodies(local, t);
  std::vector<Wrench> wrenches = forces(local, bodies);
  if (has_constraints())
    add_constraint_forces(those_of(obeyed_, rows(bodies)), bodies, local, wrenches);
  VectorXd rate(y.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    rate.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize) =
        laws_.state_derivative(local[i], bodies[i].inertia, wrenches[i]);
  return rate;
}

// Rates of places as the law has them: no force enters these.
VectorXd LinkedBodies::rates_of_bodies(const VectorXd& y) const {
  VectorXd rate(y.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    rate.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize) = laws_.state_derivative(
        stage_of(y, i), world_.bodies[static_cast<std::size_t>(bodies_[i])].inertia,
        {Vector3d::Zero(), Vector3d::Zero()});
  return rate;
}

void LinkedBodies::need_size(const VectorXd& stage, const VectorXd& y) const {
  if (stage.size() == y.size()) return;
  throw StoppedRun(
      fmt::format("integration ({} of {}) asked for the derivative of a state of {} "
                  "numbers instead of {}",
                  laws_.step_function, laws_.integrator_source, stage.size(), y.size()));
}

std::vector<RigidBodyState> LinkedBodies::advance(const std::vector<RigidBodyState>& states,
                                                  double t, double h) {
  step_ = h;
  std::vector<RigidBodyState> local = take(states);
  if (tree_ && !touched_) return advance_reduced(std::move(local), t, h);
  choose_rows(local, t);
  VectorXd y(static_cast<Eigen::Index>(local.size()) * kStateSize);
  for (std::size_t i = 0; i < local.size(); ++i)
    y.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize) = pack(local[i]);
  const OdeFunction f =
      SplitOde{[&](double time, const VectorXd& state) {
                 need_size(state, y);
                 return derivative(time, state);
               },
               [&](double, const VectorXd& state) { return rates_of_bodies(state); }};
  ++counters_.integrations;
  const VectorXd end = naming(subject(), [&] { return integrate_by(laws_, f, t, y, h, units_); });
  for (std::size_t i = 0; i < local.size(); ++i) {
    local[i] = unpack(end.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize));
    local[i].world_from_body = laws_.renormalize(local[i].world_from_body);
  }
  if (has_constraints() && world_.stabilisation &&
      world_.stabilisation->kind == scene::StabilisationKind::kProjection)
    project_local(local, t + h, true);
  return local;
}

void LinkedBodies::watch(const std::vector<RigidBodyState>& states, double t, double h) {
  // a tree's coordinates cannot open its joints
  if (!has_constraints() || (goes_without_rows() && !touched_)) return;
  const bool is_projected =
      world_.stabilisation && world_.stabilisation->kind == scene::StabilisationKind::kProjection;
  const double allowed = is_projected ? kLinkClosed : kLinkDrifts;
  const std::vector<Body> bodies = place_bodies(take(states), t);
  const auto note = [&](const std::string& name, double open) {
    if (!(open <= allowed))
      counters_.watch.note(RunWatch::Kind::kLinkOpen, fmt::format("'{}'", name),
                           {open, allowed, t, h});
  };
  for (const Terms& terms : terms_) terms.acting->note_open(bodies, note);
}

std::string LinkedBodies::subject() const {
  return "body '" + world_.bodies[bodies_.front()].name + "' and what is linked to it";
}

VectorXd LinkedBodies::multipliers_at(const std::vector<RigidBodyState>& local,
                                      const std::vector<Body>& bodies, double t,
                                      const std::vector<ContactPoint>& contacts) {
  const auto touches = [&](const ContactPoint& contact) {
    return has(contact.body_a) || has(contact.body_b);
  };
  if (!has_constraints()) return {};
  if (goes_without_rows() && std::none_of(contacts.begin(), contacts.end(), touches))
    return multipliers_of_tree(local, t);
  std::vector<Wrench> wrenches = forces(local, bodies);
  if (built::kContact) add_contacts(bodies, contacts, wrenches);
  return add_constraint_forces(rows(bodies), bodies, local, wrenches);
}

void LinkedBodies::measure(const std::vector<RigidBodyState>& states, double t,
                           const std::vector<ContactPoint>& contacts, LinkForces& measured) {
  const std::vector<RigidBodyState> local = take(states);
  time_of_stage_ = t;
  naming(subject(), [&] {
    const std::vector<Body> bodies = place_bodies(local, t);
    const VectorXd lambda = multipliers_at(local, bodies, t, contacts);
    Eigen::Index at = 0;
    for (const Terms& terms : terms_) {
      const auto count = static_cast<Eigen::Index>(terms.acting->row_count());
      if (!measured.of_effects[terms.effect].empty())
        terms.acting->measure(bodies, lambda.segment(at, count), measured.of_effects[terms.effect]);
      at += count;
    }
  });
}

// The force on A at the point, its opposite on B.
void LinkedBodies::add_contacts(const std::vector<Body>& bodies,
                                const std::vector<ContactPoint>& contacts,
                                std::vector<Wrench>& wrenches) const {
  for (const ContactPoint& contact : contacts)
    for (const auto& [body, sign] :
         {std::pair{contact.body_a, 1.0}, std::pair{contact.body_b, -1.0}}) {
      const auto found = std::lower_bound(bodies_.begin(), bodies_.end(), body);
      if (found == bodies_.end() || *found != body) continue;
      const auto place = static_cast<std::size_t>(found - bodies_.begin());
      add_force(bodies[place], sign * contact.force_on_a_world, contact.point_world,
                wrenches[place]);
    }
}

}  // namespace tumble::engines
