#include "framework/engines/stepping/moving_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/dynamics/rotation_bounds.h"
#include "framework/dynamics/state_units.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

std::vector<const effects::Effect*> acting_in(const World& world) {
  std::vector<const effects::Effect*> acting;
  for (const effects::Effect* effect : effects::all())
    if (effect->count_in(world) > 0) acting.push_back(effect);
  return acting;
}

}  // namespace

MovingWorld::MovingWorld(World world, const Laws& laws, RunCounters& counters)
    : MovingWorld(std::move(world), laws, counters, {}) {}

MovingWorld::MovingWorld(World world, const Laws& laws, RunCounters& counters,
                         std::vector<const collision::CollisionShape*> shapes)
    : world_(std::move(world)),
      laws_(laws),
      counters_(counters),
      shapes_(std::move(shapes)),
      rests_(world_.bodies.size()),
      asleep_(world_.bodies.size(), 0),
      paths_(world_.bodies.size()),
      principal_(world_.bodies.size()) {
  for (const WorldBody& body : world_.bodies) states_.push_back(body.state);
  for (int i = 0; i < size(); ++i)
    if (world_.bodies[i].immovable() && is_driven(i)) driven_.push_back(i);
  if (shapes_.empty()) {
    for (const WorldBody& body : world_.bodies) own_shapes_.emplace_back(body.shape);
    for (const collision::CollisionShape& shape : own_shapes_) shapes_.push_back(&shape);
  }
  path_bend_ = path_bend(laws);
  for (std::size_t k = 0; k < effects::all().size(); ++k)
    if (auto acting = effects::all()[k]->steady_forces({world_, laws_, counters_.effect_calls[k]}))
      steady_.push_back({static_cast<int>(k), std::move(acting)});
  acting_ = acting_in(world_);
  group_of_.assign(world_.bodies.size(), -1);
  for (LinkedGroup& group : groups_of_linked_bodies(world_)) {
    for (const int body : group.bodies) group_of_[body] = static_cast<int>(linked_.size());
    linked_.emplace_back(
        world_, laws_, counters_,
        [this](int body, const RigidBodyState& state) { return wrench_on(body, state); },
        std::move(group),
        [this](int body) { return is_left_alone(body) && !pressing_.contains(body); });
    linked_.back().project(states_, 0.0);
  }
}

void MovingWorld::stand_at(double time, const std::vector<RigidBodyState>& states) {
  time_ = target_ = time;
  states_ = states;
  // Immovable bodies stand where their motion has taken them by then, whatever `states` says of
  // them.
  for (int i = 0; i < size(); ++i)
    if (world_.bodies[i].immovable())
      states_[i].com_world = prescribed_position(world_.bodies[i], time);
}

double MovingWorld::load_forces(const std::map<int, effects::Memory>& memory) {
  static const effects::Memory none;
  double next = std::numeric_limits<double>::infinity();
  for (Steady& forces : steady_) {
    const auto remembered = memory.find(forces.effect);
    next =
        std::min(next, forces.acting->stand_at(
                           time_, remembered == memory.end() ? none : remembered->second, states_));
  }
  return next;
}

std::map<int, effects::Memory> MovingWorld::force_memory() const {
  std::map<int, effects::Memory> all;
  for (const Steady& forces : steady_)
    if (effects::Memory memory = forces.acting->memory(); !memory.empty())
      all.emplace(forces.effect, std::move(memory));
  return all;
}

bool MovingWorld::may_collide(int a, int b) const {
  const WorldBody &first = world_.bodies[a], &second = world_.bodies[b];
  if ((first.immovable() && second.immovable()) || !first.collides || !second.collides)
    return false;
  if (first.passes_movable && second.passes_movable && !first.immovable() && !second.immovable())
    return false;
  return world_.apart.empty() || !std::binary_search(world_.apart.begin(), world_.apart.end(),
                                                     std::pair(std::min(a, b), std::max(a, b)));
}

double MovingWorld::look() {
  double next = std::numeric_limits<double>::infinity();
  for (LinkedBodies& group : linked_) next = std::min(next, group.look(time_, states_));
  return next;
}

bool MovingWorld::keep_constraints(const std::vector<Event>& events) {
  bool any = false;
  for (LinkedBodies& group : linked_) {
    const auto ours = [&](int body) {
      return body >= 0 && group_of_[body] == static_cast<int>(&group - linked_.data());
    };
    if (!group.has_constraints() || std::none_of(events.begin(), events.end(), [&](const Event& e) {
          return ours(e.body_a) || ours(e.body_b);
        }))
      continue;
    group.project_velocities(states_, time_);
    any = true;
  }
  return any;
}

void MovingWorld::close_links(std::vector<RigidBodyState>& states, double t) {
  if (!world_.stabilisation || world_.stabilisation->kind != scene::StabilisationKind::kProjection)
    return;
  const RunCounters before = counters_;  // what is looked at must not show in what a run counts
  for (LinkedBodies& group : linked_)
    if (!asleep(group.bodies().front())) group.project(states, t);
  counters_ = before;
}

void MovingWorld::watch_links(double h) {
  for (LinkedBodies& group : linked_)
    if (!asleep(group.bodies().front())) group.watch(states_, time_, h);
}

// A method that sees forces a few times a step follows no body that turns about itself several
// times in it, and a search for impacts along such a path would hardly end.
void MovingWorld::refuse_fast_turning(int body) const {
  constexpr double kMostTurnOnPath = 20 * std::numbers::pi;  // rad in a step: ten turns
  // Ends that turn less stand for a path of less than kMostTurnOnPath: its middle may turn by three
  // times the way, which is less than three turns then, and by what the ends add.
  constexpr double kSlowEnds = 1.0;  // rad in a step
  const Path& path = paths_[body];
  if (is_finite(path.end) && path.smooth->turning_at_ends() < kSlowEnds) return;
  const double step = target_ - time_, speed = path.smooth->bounds().angular_speed;
  const std::string subject = fmt::format("body '{}'", world_.bodies[body].name);
  if (!is_finite(path.end) || std::isnan(speed))
    throw StoppedRun(fmt::format("{}: its state is not a number (integrator: {})", subject,
                                 laws_.integrator_source));
  // a ball looks the same however it turns
  if (shapes_[body]->is_ball() || !(speed * step > kMostTurnOnPath)) return;
  throw StoppedRun(fmt::format(
      "{} turns at {:.3g} rad/s, {:.3g} rad in a step of {:.3g} s, which no step follows. Likely "
      "something drives it beyond measure: a motor that overshoots because it holds its torque too "
      "long (\"period_s\"), a force, a spring; else it turns too far in a step: make the step "
      "(\"step_s\") shorter",
      subject, speed, speed * step, step));
}

LinkForces MovingWorld::measure_links(const std::vector<RigidBodyState>& states, double t,
                                      const std::vector<ContactPoint>& contacts) {
  LinkForces forces(world_);
  for (LinkedBodies& group : linked_) group.measure(states, t, contacts, forces);
  return forces;
}

void MovingWorld::set_path(int body, const RigidBodyState& start, const RigidBodyState& end,
                           SmoothPath::Momenta momenta) {
  Path& path = paths_[body];
  path.bounds.reset();
  path.end = end;
  path.end_known = true;
  path.smooth.emplace(start, end, world_.bodies[body].inertia, time_, target_, momenta);
  path.smooth->begin_momenta(states_[body]);
}

void MovingWorld::put_to_rest(int body, int support) {
  rests_[body] =
      Rest{support, states_[body].com_world - prescribed_position(world_.bodies[support], time_)};
  states_[body] = still_state(body, time_);
  ++counters_.bodies_put_to_rest;
}

void MovingWorld::put_to_sleep(int body) {
  states_[body].momentum_world.setZero();
  states_[body].angular_momentum_world.setZero();
  asleep_[body] = 1;
  ++counters_.bodies_put_to_sleep;
}

std::vector<RigidBodyState> MovingWorld::released(const std::vector<int>& bodies,
                                                  std::vector<RigidBodyState> states, double h) {
  const RunCounters before = counters_;
  const std::uint64_t integrations_before = integrations_in_step_;
  for (const int body : bodies) {
    states[body].momentum_world.setZero();
    states[body].angular_momentum_world.setZero();
  }
  std::vector<RigidBodyState> after = states;
  for (const int body : bodies) {
    if (group_of_[body] < 0) {
      after[body] = integrate(body, h, time_, pack(states[body]));
      continue;
    }
    LinkedBodies& group = linked_[group_of_[body]];
    if (group.bodies().front() != body) continue;
    const std::map<int, effects::Memory> held = group.held();
    group.look_again();
    group.look(time_, states);
    const std::vector<RigidBodyState> ends = group.advance(states, time_, h);
    group.remember(held);
    for (std::size_t i = 0; i < ends.size(); ++i) after[group.bodies()[i]] = ends[i];
  }
  counters_ = before;
  integrations_in_step_ = integrations_before;
  return after;
}

void MovingWorld::wake(int body) {
  states_[body] = still_state(body, time_);
  rests_[body].reset();
  asleep_[body] = 0;
  ++counters_.bodies_woken;
}

std::vector<std::pair<std::size_t, effects::Switch>> MovingWorld::due_switches() const {
  std::vector<std::pair<std::size_t, effects::Switch>> all;
  for (std::size_t k = 0; k < steady_.size(); ++k)
    for (effects::Switch& due : steady_[k].acting->due(time_)) all.emplace_back(k, std::move(due));
  return all;
}

void MovingWorld::turn(const std::pair<std::size_t, effects::Switch>& what) {
  if (what.second.on && resting(what.second.event.body_a)) wake(what.second.event.body_a);
  steady_[what.first].acting->turn(what.second, states_);
}

void MovingWorld::take_in(const scene::Scene& more) {
  const effects::BodyIndex index(world_);
  for (std::size_t k = 0; k < effects::all().size(); ++k) {
    const effects::Effect& effect = *effects::all()[k];
    if (!effect.is_asked(more)) continue;
    require(!effect.traits().ties, "only steady forces begin while a world moves");
    effect.build(more, index, world_);
    const auto place = std::find_if(steady_.begin(), steady_.end(), [&](const Steady& forces) {
      return forces.effect >= static_cast<int>(k);
    });
    if (place != steady_.end() && place->effect == static_cast<int>(k)) continue;
    if (auto acting = effect.steady_forces({world_, laws_, counters_.effect_calls[k]}))
      steady_.insert(place, {static_cast<int>(k), std::move(acting)});
  }
  acting_ = acting_in(world_);
}

RigidBodyState MovingWorld::still_state(int body, double t) const {
  const WorldBody& b = world_.bodies[body];
  RigidBodyState state = states_[body];
  if (b.immovable()) {
    state.com_world = prescribed_position(b, t);
    return state;
  }
  if (asleep(body)) return state;
  const WorldBody& support = world_.bodies[rests_[body]->support];
  state.com_world = prescribed_position(support, t) + rests_[body]->offset_from_support_world;
  state.momentum_world = b.inertia.mass * prescribed_velocity(support, t);
  // Nothing brakes its spin: there is no friction. (put_to_rest: its moments are equal, so it turns
  // evenly.)
  const Vector3d omega_world = omega_of(state, b.inertia);
  const double speed = omega_world.norm();
  if (speed > 0)
    state.world_from_body =
        (Quaterniond(Eigen::AngleAxisd(speed * (t - time_), omega_world / speed)) *
         state.world_from_body)
            .normalized();
  return state;
}

Vector3d MovingWorld::velocity_of(int body, double t) const {
  const WorldBody& b = world_.bodies[body];
  if (b.immovable()) return prescribed_velocity(b, t);
  if (asleep(body)) return Vector3d::Zero();
  if (rests_[body]) return prescribed_velocity(world_.bodies[rests_[body]->support], t);
  return b.inertia.inverse_mass * states_[body].momentum_world;
}

Wrench MovingWorld::wrench_on(int body, const RigidBodyState& state) {
  Wrench sum{Vector3d::Zero(), Vector3d::Zero()};
  for (Steady& forces : steady_) forces.acting->add(body, state, sum);
  if (const auto pressed = pressing_.find(body); pressed != pressing_.end()) {
    sum.force_world += pressed->second.force_world;
    sum.torque_world += pressed->second.torque_world;
  }
  return sum;
}

void MovingWorld::go_in_closed_form() {
  for (const WorldBody& body : world_.bodies)
    rotations_.emplace_back(body.immovable() ? Matrix3d(Matrix3d::Identity())
                                             : body.inertia.inertia_body);
  path_bend_ = 1.0;
}

// x + v t + g t^2 / 2, and the free turning: by a series of the step where it reaches, which is
// asked many times in a search for an impact.
RigidBodyState MovingWorld::fly(int body, double duration, const VectorXd& start) {
  ++counters_.integrations;
  ++integrations_in_step_;
  const Inertia& inertia = world_.bodies[body].inertia;
  RigidBodyState state = unpack(start);
  const Vector3d gravity_world =
      world_.gravity_world ? *world_.gravity_world : Vector3d(Vector3d::Zero());
  state.com_world +=
      duration * (inertia.inverse_mass * state.momentum_world + (0.5 * duration) * gravity_world);
  state.momentum_world += duration * inertia.mass * gravity_world;
  if (state.angular_momentum_world.isZero(0.0)) return state;
  const Spin spin{state.world_from_body,
                  inertia.inverse_inertia_body *
                      (state.world_from_body.conjugate() * state.angular_momentum_world)};
  std::optional<SpinSeries>& turning = paths_[body].turning;
  if (rotations_[body].is_asymmetric() && !turning && duration == target_ - time_) {
    const double fastest = bound_rotation(state, inertia, principal_of(body), {0.0}).angular_speed;
    if (duration <= SpinSeries::reach(rotations_[body].moments(), fastest))
      turning.emplace(rotations_[body].moments(), rotations_[body].body_from_principal(), spin);
  }
  state.world_from_body = turning ? turning->at(duration).world_from_body
                                  : rotations_[body].after(spin, duration).world_from_body;
  return state;
}

const VectorXd& MovingWorld::units_of(int body) {
  if (units_.size() < world_.bodies.size()) units_.resize(world_.bodies.size());
  VectorXd& units = units_[static_cast<std::size_t>(body)];
  const Inertia& inertia = world_.bodies[static_cast<std::size_t>(body)].inertia;
  if (units.size() == 0) units = units_of_state(inertia, radius_of_gyration(inertia));
  return units;
}

RigidBodyState MovingWorld::integrate(int body, double duration, double start_time,
                                      const VectorXd& start) {
  if (flies_freely(body)) return fly(body, duration, start);
  const Inertia& inertia = world_.bodies[body].inertia;
  const OdeFunction derivative = [&](double, const VectorXd& y) {
    ++counters_.derivative_evaluations;
    if (y.size() != start.size())
      throw StoppedRun("integration (" + laws_.step_function + " of " + laws_.integrator_source +
                       ") asked for the derivative of a state of " + std::to_string(y.size()) +
                       " numbers instead of " + std::to_string(start.size()));
    // Stages of a method stand off unit length by (w h)^2 / 32, and R of such a quaternion is no
    // rotation: to a needle, whose least moment turns any tilt of L into spin, that does a thousand
    // times more than what the method itself leaves. On unit quaternions nothing changes, and f(q /
    // |q|) is as smooth as f: the order stays.
    RigidBodyState state = unpack(y);
    state.world_from_body.normalize();
    return laws_.state_derivative(state, inertia, wrench_on(body, state));
  };
  ++counters_.integrations;
  ++integrations_in_step_;
  return naming("body '" + world_.bodies[body].name + "'", [&] {
    RigidBodyState state =
        unpack(integrate_by(laws_, derivative, start_time, start, duration, units_of(body)));
    state.world_from_body = laws_.renormalize(state.world_from_body);
    return state;
  });
}

void MovingWorld::begin_path(int body) {
  Path& path = paths_[body];
  path.bounds.reset();
  path.memo_time = path.measured_duration = kUnset;
  path.smooth.reset();
  path.turning.reset();
  path.end_known = true;
  path.is_stale = false;
  path.box.reset();
  if (!can_move(body) || group_of_[body] >= 0) return;
  path.start = pack(states_[body]);
  path.acceleration_world.setZero();
  for (const Steady& forces : steady_)
    forces.acting->add_acceleration(body, path.acceleration_world);
  path.acceleration_world *= path_bend_;
  path.end = integrate(body, target_ - time_, time_, path.start);
}

void MovingWorld::begin_linked_paths() {
  for (LinkedBodies& group : linked_)
    if (!asleep(group.bodies().front())) lead(group);  // they sleep together
}

void MovingWorld::lead(LinkedBodies& group) {
  const double h = target_ - time_;
  std::vector<RigidBodyState> ends = group.advance(states_, time_, h);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const int body = group.bodies()[i];
    if (const auto pressed = pressing_.find(body); pressed != pressing_.end()) {
      const auto& [force_world, torque_world] = pressed->second;
      const Inertia& inertia = world_.bodies[body].inertia;
      // what the method makes of a constant acceleration
      const double bent = 0.5 * path_bend_ * h * h;
      RigidBodyState& end = ends[i];
      end.momentum_world -= h * force_world;
      end.com_world -= (bent * inertia.inverse_mass) * force_world;
      end.angular_momentum_world -= h * torque_world;
      RigidBodyState turning = end;
      turning.angular_momentum_world = torque_world;
      end.world_from_body = turned(end.world_from_body, -bent * omega_of(turning, inertia));
    }
    set_path(body, states_[body], ends[i]);
    refuse_fast_turning(body);
  }
  integrations_in_step_ += ends.size();
}

void MovingWorld::lead_pressed(const std::map<int, Wrench>& pressing) {
  if (pressing.empty()) return;
  const StageTimer timer(counters_.integration_seconds);
  pressing_ = pressing;
  // also where a law stops: a timewarp goes on from an earlier state then
  const struct Released {
    std::map<int, Wrench>& pressing;
    ~Released() { pressing.clear(); }
  } released{pressing_};
  for (LinkedBodies& group : linked_) {
    const bool is_pressed = std::any_of(group.bodies().begin(), group.bodies().end(),
                                        [&](int body) { return pressing_.contains(body); });
    if (is_pressed && !asleep(group.bodies().front())) lead(group);
  }
}

double MovingWorld::longest_step(double asked) const {
  double longest = std::numeric_limits<double>::infinity();
  for (const effects::Effect* effect : acting_)
    longest = std::min(longest, effect->longest_step(world_, states_, asked));
  return longest;
}

void MovingWorld::begin_step(double target) {
  const StageTimer timer(counters_.integration_seconds);
  target_ = target;
  integrations_in_step_ = 0;
  for (int i = 0; i < size(); ++i) begin_path(i);
  begin_linked_paths();
}

void MovingWorld::begin_step_again(double target) {
  const StageTimer timer(counters_.integration_seconds);
  const bool same_target = target == target_;
  const std::uint64_t done = std::exchange(integrations_in_step_, 0);
  std::uint64_t kept = 0;
  target_ = target;
  for (int i = 0; i < size(); ++i) {
    Path& path = paths_[i];
    const bool alone = can_move(i) && group_of_[i] < 0 && !path.smooth && !path.is_stale;
    if (alone && same_target) {
      if (path.end_known) ++kept;
      continue;
    }
    if (!alone || !path.box || target > path.box_target) {
      begin_path(i);
      continue;
    }
    path.bounds.reset();
    path.memo_time = path.measured_duration = kUnset;
    path.turning.reset();
    path.end_known = false;
  }
  begin_linked_paths();
  counters_.undone_integrations += done - kept;
  integrations_in_step_ += kept;
}

const RigidBodyState& MovingWorld::path_end(int body) {
  Path& path = paths_[body];
  if (!path.end_known) {
    // first: a series for the whole step is made by the caller that asks for all of it
    path.end_known = true;
    path.end = integrate(body, target_ - time_, time_, path.start);
  }
  return path.end;
}

RigidBodyState MovingWorld::path(int body, double t) {
  if (!can_move(body)) return still_state(body, t);
  if (t == time_) return states_[body];
  Path& path = paths_[body];
  if (t == target_) return path_end(body);
  if (path.smooth) return path.smooth->at(t);
  if (t != path.memo_time) {
    path.memo = integrate(body, t - time_, time_, path.start);
    path.memo_time = t;
  }
  return path.memo;
}

collision::MotionState MovingWorld::motion_at(int body, double t) {
  if (can_move(body) && paths_[body].smooth && t <= target_) {
    collision::MotionState motion = paths_[body].smooth->motion_at(t);
    // of a smooth path, always known
    if (t == target_) motion.pose = {paths_[body].end.com_world, paths_[body].end.world_from_body};
    if (t == time_) motion.pose = {states_[body].com_world, states_[body].world_from_body};
    return motion;
  }
  const RigidBodyState state = path(body, t);
  collision::MotionState motion;
  motion.pose = {state.com_world, state.world_from_body};
  if (!can_move(body)) {
    motion.velocity_world = velocity_of(body, t);
    return motion;
  }
  // The rate of the path, which for a method of first order is not the state's momentum over the
  // mass.
  const Inertia& inertia = world_.bodies[body].inertia;
  motion.velocity_world = inertia.inverse_mass * states_[body].momentum_world +
                          (t - time_) * paths_[body].acceleration_world;
  if (!shapes_[body]->is_ball()) motion.omega_world = omega_of(state, inertia);
  return motion;
}

collision::Pose MovingWorld::pose_at(int body, double t) {
  if (t != time_ && t != target_) return motion_at(body, t).pose;
  const auto pose = [](const RigidBodyState& state) -> collision::Pose {
    return {state.com_world, state.world_from_body};
  };
  if (!can_move(body)) return pose(still_state(body, t));
  return pose(t == time_ ? states_[body] : path_end(body));
}

collision::MotionBounds MovingWorld::work_out_bounds(int body) {
  collision::MotionBounds bounds;
  const WorldBody& b = world_.bodies[body];
  if (asleep(body)) return bounds;
  if (!can_move(body)) {
    const scene::PrescribedMotion& m =
        b.immovable() ? b.motion : world_.bodies[rests_[body]->support].motion;
    bounds.acceleration_deviation =
        m.amplitude_m.norm() * m.angular_frequency_rad_s * m.angular_frequency_rad_s;
    return bounds;
  }
  if (paths_[body].smooth) return paths_[body].smooth->bounds();
  bounds.acceleration_world = paths_[body].acceleration_world;
  if (shapes_[body]->is_ball()) return bounds;  // however it turns, it looks the same
  bound_turning(body, target_ - time_, bounds);
  return bounds;
}

collision::Motion MovingWorld::motion(int body) {
  if (!paths_[body].bounds) paths_[body].bounds = work_out_bounds(body);
  return {[this, body](double t) { return motion_at(body, t); }, *paths_[body].bounds};
}

double MovingWorld::fastest_in_step(int body) {
  const collision::MotionState start = motion_at(body, time_), end = motion_at(body, target_);
  const double radius = shapes_[body]->is_half_space() ? 0.0 : shapes_[body]->bounding_radius();
  return std::max(start.velocity_world.norm(), end.velocity_world.norm()) +
         std::max(start.omega_world.norm(), end.omega_world.norm()) * radius;
}

collision::SweptBox MovingWorld::swept_box(int body) {
  if (has_roomy_box(body)) return *paths_[body].box;
  const double radius = shapes_[body]->bounding_radius();
  const double h = target_ - time_;
  const Vector3d start = path(body, time_).com_world, end = path(body, target_).com_world;
  // Between its ends a parabola leaves their box by at most a h^2 / 8; a shaken body by at most its
  // amplitude.
  Vector3d bulge = Vector3d::Zero();
  if (can_move(body) && paths_[body].smooth) {
    const collision::MotionBounds& bounds = paths_[body].smooth->bounds();
    bulge =
        (bounds.acceleration_world.cwiseAbs() + Vector3d::Constant(bounds.acceleration_deviation)) *
        (h * h / 8);
  } else if (can_move(body)) {
    bulge = paths_[body].acceleration_world.cwiseAbs() * (h * h / 8);
  } else {
    const int mover = resting(body) ? rests_[body]->support : body;
    const scene::PrescribedMotion& m = world_.bodies[mover].motion;
    bulge =
        m.amplitude_m.cwiseAbs() * std::min(1.0, std::pow(m.angular_frequency_rad_s * h, 2) / 8);
  }
  const double contact_margin =
      built::kContact && world_.contact && std::isfinite(radius) ? kNegligible * radius : 0.0;
  const Vector3d margin =
      bulge + Vector3d::Constant(radius + contact_margin) +
      kCoordinateRounding * (start.cwiseAbs() + end.cwiseAbs() +
                             Vector3d::Constant(std::isfinite(radius) ? radius : 0.0));
  const collision::SweptBox box{start.cwiseMin(end) - margin, start.cwiseMax(end) + margin,
                                can_move(body) || is_driven(body)};
  // contacts begin steps again
  if (built::kContact && world_.contact && can_move(body) && !paths_[body].smooth) {
    paths_[body].box = box;
    paths_[body].box_target = target_;
  }
  return box;
}

void MovingWorld::commit(double t) {
  const std::uint64_t before = integrations_in_step_;
  std::vector<RigidBodyState> arrived;
  {
    const StageTimer timer(counters_.integration_seconds);
    arrived.reserve(states_.size());
    for (int i = 0; i < size(); ++i) {
      arrived.push_back(path(i, t));
      watch_turning(i, arrived.back(), t - time_);
    }
  }
  const bool is_cut_short = t < target_;
  if (is_cut_short) counters_.undone_integrations += before;
  states_ = std::move(arrived);
  time_ = t;
  // Momenta that change evenly between a step's ends fit rods and joints at these only, and what
  // contacts give along the directions of the middle fits them there. A tree goes on from states
  // that fit its joints, so that nothing jumps where its last contact ends.
  for (LinkedBodies& group : linked_) {
    const std::optional<SmoothPath>& path = paths_[group.bodies().front()].smooth;
    if ((is_cut_short || group.has_tree()) && path && path->momenta() == SmoothPath::Momenta::kEven)
      group.project_velocities(states_, time_);
  }
}

Body MovingWorld::body_at_impact(int index) const {
  const WorldBody& b = world_.bodies[index];
  const RigidBodyState state = can_move(index) ? states_[index] : still_state(index, time_);
  Body body;
  body.inertia = b.inertia;
  body.com_world = state.com_world;
  body.world_from_body = state.world_from_body;
  body.velocity_world = velocity_of(index, time_);
  body.omega_world = b.immovable() ? Vector3d(Vector3d::Zero()) : omega_of(state, b.inertia);
  return body;
}

}  // namespace tumble::engines
