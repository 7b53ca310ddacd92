#include "framework/engines/stepping/linked_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "framework/dynamics/joint_rows.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/guarded_laws.h"

namespace tumble::engines {
namespace {

// Places count as on their constraints within this part of the group's size: some roundings of coordinates that are summed up along
// a chain.
constexpr double kOnConstraint = 1e-14;
constexpr int kMostProjections = 8;   // Newton's method doubles the digits; a step leaves few missing

Vector3d point_world(const Body& body, const Vector3d& point_body) { return body.com_world + body.world_from_body * point_body; }
Vector3d velocity_at(const Body& body, const Vector3d& point) { return body.velocity_world + body.omega_world.cross(point - body.com_world); }
AnchorState anchor_of(const Body& body, const Vector3d& point_body) {
  const Vector3d point = point_world(body, point_body);
  return {point, velocity_at(body, point)};
}

Matrix3d inverse_inertia_world(const Body& body) {
  if (body.inertia.inverse_mass == 0.0) return Matrix3d::Zero();
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return R * body.inertia.inverse_inertia_body * R.transpose();
}

Body body_of(const RigidBodyState& state, const Inertia& inertia) {
  return {inertia, state.com_world, state.world_from_body.normalized(), inertia.inverse_mass * state.momentum_world, omega_of(state, inertia)};
}

void add_force(const Body& body, const Vector3d& force, const Vector3d& point, Wrench& wrench) {
  wrench.force_world += force;
  wrench.torque_world += (point - body.com_world).cross(force);
}

// Does `work`; a StoppedRun out of it is told again with the link in front. Words are made where they are needed only: this is asked at every stage.
template <class Work>
auto of_link(const char* kind, const std::string& name, Work&& work) {
  try {
    return work();
  } catch (const OutOfTime&) {
    throw;
  } catch (const StoppedRun& stop) {
    throw StoppedRun(fmt::format("{} '{}': {}", kind, name, stop.what()));
  }
}

}  // namespace

std::vector<std::vector<int>> groups_of_linked_bodies(const World& world) {
  const int n = static_cast<int>(world.bodies.size());
  std::vector<int> leader(n);
  std::iota(leader.begin(), leader.end(), 0);
  std::vector<bool> linked(n, false);
  const auto find = [&](int i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  const auto movable = [&](int body) { return body >= 0 && !world.bodies[body].immovable(); };
  const auto tie = [&](int a, int b) {
    for (const int body : {a, b})
      if (movable(body)) linked[body] = true;
    if (!movable(a) || !movable(b)) return;
    const int i = find(a), j = find(b);
    leader[std::max(i, j)] = std::min(i, j);
  };
  for (const RodLink& link : world.rods) tie(link.a.body, link.b.body);
  for (const JointLink& link : world.joints) tie(link.a.body, link.b.body);
  for (const effects::Effect* effect : effects::all()) {
    if (!effect->traits().ties) continue;
    for (int entry = 0; entry < effect->count_in(world); ++entry) {
      int first = -1;   // movable one
      for (const int body : effect->bodies_of(world, entry)) {
        tie(first, body);
        if (first < 0 && movable(body)) first = body;
      }
    }
  }
  std::vector<std::vector<int>> by_leader(n), groups;
  for (int i = 0; i < n; ++i)
    if (linked[i]) by_leader[find(i)].push_back(i);
  for (auto& group : by_leader)
    if (!group.empty()) groups.push_back(std::move(group));
  return groups;
}

LinkedBodies::LinkedBodies(const World& world, const Laws& laws, RunCounters& counters, OuterWrench outer_wrench, std::vector<int> bodies)
    : world_(world), laws_(laws), counters_(counters), outer_wrench_(std::move(outer_wrench)), bodies_(std::move(bodies)) {
  const auto ours = [&](const Anchor& a, const Anchor& b) {
    return std::binary_search(bodies_.begin(), bodies_.end(), a.body) || std::binary_search(bodies_.begin(), bodies_.end(), b.body);
  };
  const auto collect = [&](const auto& links, std::vector<Link>& into) {
    for (int k = 0; k < static_cast<int>(links.size()); ++k)
      if (ours(links[k].a, links[k].b)) into.push_back({k, end_of(links[k].a), end_of(links[k].b)});
  };
  for (std::size_t k = 0; k < effects::all().size(); ++k)
    if (auto terms = effects::all()[k]->group_terms({world_, laws_, counters_.effect_calls[k]}, *this)) terms_.push_back({k, std::move(terms)});
  collect(world.rods, rods_);
  collect(world.joints, joints_);
  for (int k = 0; k < static_cast<int>(world.motors.size()); ++k)
    if (std::any_of(joints_.begin(), joints_.end(), [&](const Link& joint) { return joint.index == world.motors[k].joint; })) motors_.push_back(k);
  most_rows_ = rods_.size();
  for (const Link& link : joints_) most_rows_ += static_cast<std::size_t>(row_count(world.joints[link.index].kind));
  torques_.assign(motors_.size(), 0.0);
  next_looks_.assign(motors_.size(), 0.0);
}

bool LinkedBodies::has(int body) const { return std::binary_search(bodies_.begin(), bodies_.end(), body); }

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

void LinkedBodies::put(const std::vector<RigidBodyState>& local, std::vector<RigidBodyState>& states) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) states[bodies_[i]] = local[i];
}

std::vector<Body> LinkedBodies::place_bodies(const std::vector<RigidBodyState>& local, double t) const {
  std::vector<Body> bodies;
  bodies.reserve(bodies_.size() + fixed_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) bodies.push_back(body_of(local[i], world_.bodies[bodies_[i]].inertia));
  for (const int fixed : fixed_) {
    Body body{infinite_inertia(), Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()};
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
std::vector<Wrench> LinkedBodies::forces(const std::vector<RigidBodyState>& local, const std::vector<Body>& bodies) {
  const StageTimer timer(counters_.force_seconds);
  std::vector<Wrench> wrenches(bodies.size(), {Vector3d::Zero(), Vector3d::Zero()});
  for (std::size_t i = 0; i < bodies_.size(); ++i) wrenches[i] = outer_wrench_(bodies_[i], local[i]);
  for (const Terms& terms : terms_) terms.acting->add_forces(bodies, wrenches);
  if (built::kMotor) add_motors(bodies, wrenches);
  return wrenches;
}

void LinkedBodies::add_motors(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) const {
  for (std::size_t k = 0; k < motors_.size(); ++k) {
    const int joint = world_.motors[motors_[k]].joint;
    const auto link = std::find_if(joints_.begin(), joints_.end(), [&](const Link& l) { return l.index == joint; });
    const HingeMotion hinge = hinge_motion(world_.joints[joint], bodies[link->a.place], bodies[link->b.place]);
    wrenches[link->b.place].torque_world += torques_[k] * hinge.axis_world;
    wrenches[link->a.place].torque_world -= torques_[k] * hinge.axis_world;
  }
}

namespace {

// A motor measures its hinge's angle within a turn: from half a turn between two looks on it is lost. Nothing comes so far that does not
// overshoot more each time, because the torque that brakes it is held for too long.
void refuse_lost(const std::string& hinge, const scene::MotorSpec& law, const HingeMotion& motion) {
  const double turn = std::abs(motion.rate) * law.period_s;
  if (law.stiffness_n_m_rad == 0.0 || !(turn > std::numbers::pi)) return;
  throw StoppedRun(fmt::format("the motor of '{}' finds its hinge turning at {:.3g} rad/s, {:.3g} rad between two looks {:.3g} s apart: beyond half a turn it does not know its angle. "
                               "Likely it overshoots more each time, for it holds its torque too long: a shorter \"period_s\", or less \"damping_n_m_s_rad\" or \"stiffness_n_m_rad\"",
                               hinge, motion.rate, turn, law.period_s));
}

}  // namespace

double LinkedBodies::look(double time, const std::vector<RigidBodyState>& states) {
  double next = std::numeric_limits<double>::infinity();
  if (!built::kMotor || motors_.empty()) return next;
  const StageTimer timer(counters_.control_seconds);
  const std::vector<Body> bodies = place_bodies(take(states), time);
  for (std::size_t k = 0; k < motors_.size(); ++k) {
    const scene::MotorSpec& law = world_.motors[motors_[k]].law;
    if (time >= next_looks_[k]) {
      ++counters_.motor_calls;
      const int joint = world_.motors[motors_[k]].joint;
      const auto link = std::find_if(joints_.begin(), joints_.end(), [&](const Link& l) { return l.index == joint; });
      const HingeMotion hinge = hinge_motion(world_.joints[joint], bodies[link->a.place], bodies[link->b.place]);
      refuse_lost(world_.joints[joint].name, law, hinge);
      const double target = law.offset_rad + law.amplitude_rad * std::sin(2 * std::numbers::pi * law.frequency_hz * time + law.phase_rad);
      const double torque = law.stiffness_n_m_rad * (target - hinge.angle) - law.damping_n_m_s_rad * hinge.rate;
      torques_[k] = std::clamp(torque, -law.largest_torque_n_m, law.largest_torque_n_m);
      next_looks_[k] = law.period_s * (std::floor(time / law.period_s * (1 + 1e-12)) + 1);
    }
    next = std::min(next, next_looks_[k]);
  }
  return next;
}

std::vector<Constraint> LinkedBodies::rows(const std::vector<Body>& bodies) {
  std::vector<Constraint> rows;
  rows.reserve(most_rows_);
  if (built::kRod) append_rods(bodies, rows);
  if (built::kJoint) append_joints(bodies, rows);
  return rows;
}

void LinkedBodies::append_rods(const std::vector<Body>& bodies, std::vector<Constraint>& rows) {
  for (const Link& link : rods_) {
    ++counters_.rod_calls;
    const RodLink& rod = world_.rods[link.index];
    rows.push_back({link.a.place, link.b.place, of_link("rod", rod.name, [&] { return laws_.rod_row(bodies[link.a.place], link.a.point_body, bodies[link.b.place], link.b.point_body, rod.length); })});
  }
}

void LinkedBodies::append_joints(const std::vector<Body>& bodies, std::vector<Constraint>& rows) {
  for (const Link& link : joints_) {
    ++counters_.joint_calls;
    append_joint_rows(world_.joints[link.index], bodies[link.a.place], link.a.place, bodies[link.b.place], link.b.place, rows);
  }
}

std::vector<Constraint> LinkedBodies::constraint_rows(const std::vector<RigidBodyState>& states, double t) {
  if (!has_constraints()) return {};
  auto all = rows(place_bodies(take(states), t));
  for (Constraint& row : all) {   // all fixed ends are one: none of them moves by an impulse
    row.body_a = std::min(row.body_a, fixed_end());
    row.body_b = std::min(row.body_b, fixed_end());
  }
  return all;
}

void add_rows(LinkedBodies& group, const std::vector<RigidBodyState>& states, double t, const std::map<int, int>& places, ContactProblem& problem) {
  const int fixed = static_cast<int>(problem.bodies.size());
  bool uses_fixed = false;
  for (Constraint row : group.constraint_rows(states, t)) {
    for (int* const body : {&row.body_a, &row.body_b}) {
      uses_fixed = uses_fixed || *body >= group.fixed_end();
      *body = *body < group.fixed_end() ? places.at(group.bodies()[static_cast<std::size_t>(*body)]) : fixed;
    }
    problem.rows.push_back(row);
  }
  if (uses_fixed) problem.bodies.push_back({0.0, Matrix3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()});
}

void keep_rates(ContactProblem& problem) {
  const auto rate = [&](int body, const Vector6d& jacobian) {
    const PushedBody& pushed = problem.bodies[static_cast<std::size_t>(body)];
    return jacobian.head<3>().dot(pushed.velocity_world) + jacobian.tail<3>().dot(pushed.omega_world);
  };
  problem.row_targets.resize(static_cast<Eigen::Index>(problem.rows.size()));
  for (std::size_t k = 0; k < problem.rows.size(); ++k) {
    const auto& [a, b, row] = problem.rows[k];
    problem.row_targets[static_cast<Eigen::Index>(k)] = rate(a, row.jacobian_a) + rate(b, row.jacobian_b);
  }
}

VectorXd LinkedBodies::add_constraint_forces(const std::vector<Body>& bodies, const std::vector<RigidBodyState>& local, std::vector<Wrench>& wrenches) {
  const StageTimer timer(counters_.constraint_seconds);
  const std::vector<Constraint> all = rows(bodies);
  std::vector<ConstrainedBody> constrained;
  constrained.reserve(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    ConstrainedBody body{bodies[i].inertia.inverse_mass, inverse_inertia_world(bodies[i]), Vector6d::Zero()};
    if (i < bodies_.size()) {
      const Vector3d gyroscopic = bodies[i].omega_world.cross(local[i].angular_momentum_world);
      body.free_acceleration << body.inverse_mass * wrenches[i].force_world, body.inverse_inertia_world * (wrenches[i].torque_world - gyroscopic);
    } else if (fixed_[i - bodies_.size()] >= 0) {
      const scene::PrescribedMotion& m = world_.bodies[fixed_[i - bodies_.size()]].motion;   // a shaken end accelerates
      if (m.angular_frequency_rad_s != 0.0)
        body.free_acceleration.head<3>() = -m.angular_frequency_rad_s * m.angular_frequency_rad_s *
                                           (bodies[i].com_world - world_.bodies[fixed_[i - bodies_.size()]].com_at_0_world - m.velocity_m_s * time_of_stage_);
    }
    constrained.push_back(body);
  }
  VectorXd wanted = VectorXd::Zero(static_cast<Eigen::Index>(all.size()));
  if (world_.stabilisation && world_.stabilisation->kind == scene::StabilisationKind::kBaumgarte)
    for (std::size_t k = 0; k < all.size(); ++k)
      wanted[static_cast<Eigen::Index>(k)] = laws_.baumgarte_acceleration(all[k].row.value, all[k].row.rate, world_.stabilisation->time_constant_s);
  ++counters_.constraint_solves;
  const VectorXd multipliers = laws_.constraint_multipliers(all, constrained, wanted);
  if (multipliers.size() != wanted.size()) throw StoppedRun("rods and joints (constraint_multipliers of " + laws_.constraint_source + ") returned " + std::to_string(multipliers.size()) + " multipliers for " + std::to_string(wanted.size()) + " constraints");
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

VectorXd LinkedBodies::derivative(double t, const VectorXd& y) {
  ++counters_.derivative_evaluations;
  std::vector<RigidBodyState> local;
  local.reserve(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) local.push_back(unpack(y.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize)));
  time_of_stage_ = t;
  const std::vector<Body> bodies = place_bodies(local, t);
  std::vector<Wrench> wrenches = forces(local, bodies);
  if (has_constraints()) add_constraint_forces(bodies, local, wrenches);
  VectorXd rate(y.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    rate.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize) = laws_.state_derivative(local[i], bodies[i].inertia, wrenches[i]);
  return rate;
}

std::vector<RigidBodyState> LinkedBodies::advance(const std::vector<RigidBodyState>& states, double t, double h) {
  step_ = h;
  std::vector<RigidBodyState> local = take(states);
  VectorXd y(static_cast<Eigen::Index>(local.size()) * kStateSize);
  for (std::size_t i = 0; i < local.size(); ++i) y.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize) = pack(local[i]);
  const OdeFunction f = [&](double time, const VectorXd& state) {
    if (state.size() != y.size())
      throw StoppedRun("integration (integrate_step of " + laws_.integrator_source + ") asked for the derivative of a state of " + std::to_string(state.size()) + " numbers instead of " + std::to_string(y.size()));
    return derivative(time, state);
  };
  ++counters_.integrations;
  const VectorXd end = naming(whose(), [&] { return laws_.integrate_step(f, t, y, h); });
  for (std::size_t i = 0; i < local.size(); ++i) {
    local[i] = unpack(end.segment(static_cast<Eigen::Index>(i) * kStateSize, kStateSize));
    local[i].world_from_body = laws_.renormalize(local[i].world_from_body);
  }
  if (has_constraints() && world_.stabilisation && world_.stabilisation->kind == scene::StabilisationKind::kProjection) project_local(local, t + h, true);
  return local;
}

// The largest error of these rows, over the group's size: its longest rod, its farthest coordinate.
double LinkedBodies::open_part(const std::vector<Body>& bodies, const std::vector<Constraint>& rows) const {
  double worst = 0.0, size = 0.0;
  for (const Constraint& c : rows) worst = std::isnan(c.row.value) ? c.row.value : std::max(worst, std::abs(c.row.value));
  for (const Link& link : rods_) size = std::max(size, world_.rods[link.index].length);
  for (const Body& body : bodies) size = std::max(size, body.com_world.cwiseAbs().maxCoeff());
  return worst == 0.0 ? 0.0 : worst / size;
}

std::vector<ConstrainedBody> LinkedBodies::constrained(const std::vector<Body>& bodies) {
  std::vector<ConstrainedBody> result;
  result.reserve(bodies.size());
  for (const Body& body : bodies) result.push_back({body.inertia.inverse_mass, inverse_inertia_world(body), Vector6d::Zero()});
  return result;
}

VectorXd LinkedBodies::correction(const std::vector<Constraint>& rows, const std::vector<ConstrainedBody>& bodies, const VectorXd& error) {
  ++counters_.constraint_corrections;
  VectorXd change = laws_.constraint_correction(rows, bodies, error);
  if (change.size() != 6 * static_cast<Eigen::Index>(bodies.size()))
    throw StoppedRun("rods and joints (constraint_correction of " + laws_.constraint_source + ") returned " + std::to_string(change.size()) + " numbers instead of 6 a body");
  return change;
}

LinkedBodies::Instant LinkedBodies::at_instant(const std::vector<RigidBodyState>& states, double t) try {
  const std::vector<Body> bodies = place_bodies(take(states), t);
  return {rows(bodies), constrained(bodies)};
} catch (const OutOfTime&) {
  throw;
} catch (const StoppedRun& stop) {
  throw StoppedRun(whose() + ": " + stop.what());
}

VectorXd LinkedBodies::reaction(const Instant& instant, const VectorXd& change) try {
  const StageTimer timer(counters_.constraint_seconds);
  const auto rate = [&](int body, const Vector6d& jacobian) { return jacobian.dot(change.segment<6>(6 * static_cast<Eigen::Index>(body))); };
  VectorXd error(static_cast<Eigen::Index>(instant.rows.size()));
  for (std::size_t k = 0; k < instant.rows.size(); ++k) {
    const auto& [a, b, row] = instant.rows[k];
    error[static_cast<Eigen::Index>(k)] = rate(a, row.jacobian_a) + rate(b, row.jacobian_b);
  }
  return correction(instant.rows, instant.bodies, error);
} catch (const OutOfTime&) {
  throw;
} catch (const StoppedRun& stop) {
  throw StoppedRun(whose() + ": " + stop.what());
}

void LinkedBodies::project_local(std::vector<RigidBodyState>& local, double t, bool places) try {
  const StageTimer timer(counters_.constraint_seconds);
  const auto correct = [&](const std::vector<Body>& bodies, const std::vector<Constraint>& all, bool of_places) {
    VectorXd error(static_cast<Eigen::Index>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k) error[static_cast<Eigen::Index>(k)] = of_places ? all[k].row.value : all[k].row.rate;
    return correction(all, constrained(bodies), error);
  };
  std::vector<Body> bodies = place_bodies(local, t);
  std::vector<Constraint> all = rows(bodies);
  for (int round = 0; places && round < kMostProjections; ++round) {
    if (open_part(bodies, all) <= kOnConstraint) break;
    const VectorXd change = correct(bodies, all, true);
    for (std::size_t i = 0; i < local.size(); ++i) {
      const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
      // Momenta follow: the velocities stay, and with them, for a turned body, the angular velocity rather than its momentum.
      const Vector3d omega = bodies[i].omega_world, turn = change.segment<3>(at + 3);
      local[i].com_world += change.segment<3>(at);
      const double angle = turn.norm();
      if (angle > 0) local[i].world_from_body = (Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * local[i].world_from_body).normalized();
      local[i].angular_momentum_world = angular_momentum_of(omega, local[i].world_from_body, bodies[i].inertia);
    }
    bodies = place_bodies(local, t);
    all = rows(bodies);
  }
  if (const double left = places ? open_part(bodies, all) : 0.0; !(left <= kProjected)) counters_.watch.note(RunWatch::Kind::kProjectionOpen, whose(), {left, kProjected, t, step_});
  const VectorXd change = correct(bodies, all, false);
  for (std::size_t i = 0; i < local.size(); ++i) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
    local[i].momentum_world += bodies[i].inertia.mass * change.segment<3>(at);
    local[i].angular_momentum_world += angular_momentum_of(change.segment<3>(at + 3), local[i].world_from_body, bodies[i].inertia);
  }
} catch (const OutOfTime&) {
  throw;
} catch (const StoppedRun& stop) {
  throw StoppedRun(whose() + ": " + stop.what());
}

void LinkedBodies::project_velocities(std::vector<RigidBodyState>& states, double t) {
  if (!has_constraints()) return;
  std::vector<RigidBodyState> local = take(states);
  project_local(local, t, false);
  put(local, states);
}

void LinkedBodies::project(std::vector<RigidBodyState>& states, double t) {
  if (!has_constraints()) return;
  std::vector<RigidBodyState> local = take(states);
  project_local(local, t, true);
  put(local, states);
}

void LinkedBodies::watch(const std::vector<RigidBodyState>& states, double t, double h) {
  if (!has_constraints()) return;
  const bool is_projected = world_.stabilisation && world_.stabilisation->kind == scene::StabilisationKind::kProjection;
  const double allowed = is_projected ? kLinkClosed : kLinkDrifts;
  const std::vector<Body> bodies = place_bodies(take(states), t);
  const auto note = [&](const std::string& name, double open) {
    if (!(open <= allowed)) counters_.watch.note(RunWatch::Kind::kLinkOpen, fmt::format("'{}'", name), {open, allowed, t, h});
  };
  const auto at = [&](const End& end) { return point_world(bodies[end.place], end.point_body); };
  if (built::kRod)
    for (const Link& link : rods_) {
      const RodLink& rod = world_.rods[link.index];
      note(rod.name, std::abs((at(link.a) - at(link.b)).norm() - rod.length) / rod.length);
    }
  if (!built::kJoint) return;
  for (const Link& link : joints_) {
    const JointLink& joint = world_.joints[link.index];
    note(joint.name, (at(link.a) - at(link.b)).norm() / size_of_joint(link));
    const Quaterniond a = bodies[link.a.place].world_from_body * joint.a_from_joint, b = bodies[link.b.place].world_from_body * joint.b_from_joint;
    if (joint.kind == scene::JointKind::kHinge) note(joint.name, (a * Vector3d::UnitZ()).cross(b * Vector3d::UnitZ()).norm());
    if (joint.kind == scene::JointKind::kWeld) note(joint.name, 2.0 * (a.conjugate() * b).vec().norm());
  }
}

// The longer arm of the two bodies; of bodies that are held at their centres, how far their mass lies from there. [m]
double LinkedBodies::size_of_joint(const Link& joint) const {
  double size = 0.0;
  for (const End* end : {&joint.a, &joint.b}) {
    if (end->place >= static_cast<int>(bodies_.size())) continue;
    const Inertia& inertia = world_.bodies[bodies_[end->place]].inertia;
    size = std::max({size, end->point_body.norm(), std::sqrt(0.5 * inertia.inertia_body.trace() * inertia.inverse_mass)});
  }
  return size > 0.0 ? size : 1.0;
}

std::string LinkedBodies::whose() const { return "body '" + world_.bodies[bodies_.front()].name + "' and what is linked to it"; }

void LinkedBodies::measure(const std::vector<RigidBodyState>& states, double t, const std::vector<ContactPoint>& contacts, LinkForces& measured) try {
  const std::vector<RigidBodyState> local = take(states);
  time_of_stage_ = t;
  const std::vector<Body> bodies = place_bodies(local, t);
  for (const Terms& terms : terms_)
    if (!measured.of_effects[terms.effect].empty()) terms.acting->measure(bodies, measured.of_effects[terms.effect]);
  if (!has_constraints()) return;
  std::vector<Wrench> wrenches = forces(local, bodies);
  if (built::kContact) add_contacts(bodies, contacts, wrenches);
  const VectorXd multipliers = add_constraint_forces(bodies, local, wrenches);
  Eigen::Index at = 0;
  // A rod's multiplier pushes A along the growing length: away from B.
  if (built::kRod)
    for (const Link& link : rods_) measured.rods[link.index] = -multipliers[at++];
  if (built::kJoint)
    for (const Link& link : joints_) {
      measured.joints[link.index] = multipliers.segment<3>(at).norm();
      at += row_count(world_.joints[link.index].kind);
    }
} catch (const OutOfTime&) {
  throw;
} catch (const StoppedRun& stop) {
  throw StoppedRun(whose() + ": " + stop.what());
}

// The force on A at the point, its opposite on B.
void LinkedBodies::add_contacts(const std::vector<Body>& bodies, const std::vector<ContactPoint>& contacts, std::vector<Wrench>& wrenches) const {
  for (const ContactPoint& contact : contacts)
    for (const auto& [body, sign] : {std::pair{contact.body_a, 1.0}, std::pair{contact.body_b, -1.0}}) {
      const auto found = std::lower_bound(bodies_.begin(), bodies_.end(), body);
      if (found == bodies_.end() || *found != body) continue;
      const auto place = static_cast<std::size_t>(found - bodies_.begin());
      add_force(bodies[place], sign * contact.force_on_a_world, contact.point_world, wrenches[place]);
    }
}

LinkForces::LinkForces(const World& world) : rods(world.rods.size()), joints(world.joints.size()) {
  for (const effects::Effect* effect : effects::all()) of_effects.emplace_back(effect->measured_as() == nullptr ? 0 : effect->count_in(world));
}

void record(LinkForces forces, Frame& frame) {
  for (std::size_t k = 0; k < forces.of_effects.size(); ++k)
    if (const auto kept = effects::all()[k]->measured_as()) frame.*kept = std::move(forces.of_effects[k]);
  frame.rod_tensions = std::move(forces.rods);
  frame.joint_forces = std::move(forces.joints);
}

}  // namespace tumble::engines
