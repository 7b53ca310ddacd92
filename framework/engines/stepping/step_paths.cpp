// Where a step leads the bodies: in closed form, by the laws' method, or with the island that links
// tie them into. Part of MovingWorld.
#include <algorithm>

#include "framework/dynamics/state_units.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

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

}  // namespace tumble::engines
