#include "framework/engines/stepping/moving_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "framework/core/error.h"
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
