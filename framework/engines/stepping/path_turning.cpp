// How paths turn: bounds for the collision finding, and steps in which these hold. Part of
// MovingWorld.
//
// The path of a body within a step is one step of the laws' method, of any length. A method turns
// the body at a rate that is not quite the angular velocity of the states it gives; by how much is
// measured on the path itself.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/dynamics/rotation_bounds.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {
namespace {

// A step in which a body turns by less, at most, is looked at as it is [rad]. Up to here the error
// of a method of order 1 to 5 grows steadily within the step: its next term is at most (1/2)^2 of
// its first, half the angle being what quaternion and Taylor series go by. From 1.5 rad on the
// error comes and goes within the step, and three looks at it miss up to 30 times its size.
constexpr double kMostTurnInStep = 1.0;
// a cut step stays so much below, for what the path's error adds to the bound
constexpr double kUnder = 0.01;

// The turning error of a step, too, has to be small for that [rad]: where moments differ a thousand
// times, a method can break down long before the body has turned by one radian.
constexpr double kMostDrift = 0.1;

// Measured at the middle and at the end, over this part of the step; the rate is off by its square,
// and by 1e-13 from rounding.
constexpr double kLook = 1e-3;
// What is seen there, against the largest in the step: at most 1.8 times in 2e4 tops with moments
// as far apart as 1 : 1e8, by Euler, midpoint, Heun, Kutta and Runge-Kutta of orders 4 and 5,
// within the two limits above.
constexpr double kUnseenTurn = 2.0;

// A body is round where its moments differ by no more than computing them from a mesh leaves.
constexpr double kSameMoments = 1e-12;

// a method whose error does not shrink with the step is not helped by shorter ones
constexpr int kMostHalvings = 12;

// The rotation from a to b as axis times angle. [rad]
Vector3d turn_between(const Quaterniond& a, const Quaterniond& b) {
  Quaterniond turn = b * a.conjugate();
  if (turn.w() < 0) turn.coeffs() *= -1.0;
  const double sine = turn.vec().norm();
  return sine > 0 ? Vector3d(turn.vec() * (2.0 * std::atan2(sine, turn.w()) / sine))
                  : Vector3d(2.0 * turn.vec());
}

}  // namespace

double MovingWorld::torque_bound(int body) const {
  double bound = 0.0;
  for (const Steady& forces : steady_) bound += forces.acting->torque_bound(body);
  return bound;
}

const PrincipalMoments& MovingWorld::principal_of(int body) {
  if (!principal_[body]) principal_[body] = principal_moments(world_.bodies[body].inertia);
  return *principal_[body];
}

// Bounds |rate of the path - omega of its states| on a path of this duration. [rad/s]
double MovingWorld::turning_error(int body, double duration) {
  if (flies_freely(body)) return 0.0;
  Path& path = paths_[body];
  if (duration == path.measured_duration) return path.turning_error;
  const Inertia& inertia = world_.bodies[body].inertia;
  const auto after = [&](double t) {
    return time_ + t == target_ ? path_end(body) : integrate(body, t, time_, path.start);
  };
  const auto error_before = [&](double t, const RigidBodyState& state) -> double {
    const double look = kLook * duration;
    const RigidBodyState earlier = after(t - look);
    const Vector3d rate_world = turn_between(earlier.world_from_body, state.world_from_body) / look;
    return (rate_world - 0.5 * (omega_of(earlier, inertia) + omega_of(state, inertia))).norm();
  };
  const RigidBodyState half = after(0.5 * duration), end = after(duration);
  // An error that is zero at both looks shows in the angle, which two half steps give with another
  // error.
  const RigidBodyState twice_half =
      integrate(body, 0.5 * duration, time_ + 0.5 * duration, pack(half));
  const double drift = twice_half.world_from_body.angularDistance(end.world_from_body);
  path.turning_error =
      kUnseenTurn * std::max({error_before(0.5 * duration, half), error_before(duration, end),
                              3.0 * drift / duration});
  path.measured_duration = duration;
  return path.turning_error;
}

// @return whether they are of use: the step turns the body little, and the path goes wrong by
// little
bool MovingWorld::bound_turning(int body, double duration, collision::MotionBounds& bounds) {
  const Inertia& inertia = world_.bodies[body].inertia;
  Disturbance disturbance{.duration = duration, .torque = torque_bound(body)};
  if (bound_rotation(states_[body], inertia, principal_of(body), disturbance).angular_speed == 0.0)
    return true;
  disturbance.angular_velocity_error = turning_error(body, duration);
  const RotationBounds rotation =
      bound_rotation(states_[body], inertia, principal_of(body), disturbance);
  bounds.angular_speed = rotation.angular_speed;
  bounds.angular_acceleration = rotation.angular_acceleration;
  bounds.angular_velocity_error = disturbance.angular_velocity_error;
  return bounds.angular_speed * duration <= kMostTurnInStep &&
         bounds.angular_velocity_error * duration <= kMostDrift;
}

// The longest part of `duration`, within a factor of about two, in which bounds on the body's
// turning hold.
double MovingWorld::resolved_duration(int body, double duration, bool measures_path) {
  collision::MotionBounds bounds;
  if (measures_path && bound_turning(body, duration, bounds)) return duration;
  const Disturbance disturbance{.duration = duration, .torque = torque_bound(body)};
  // |omega| <= (|L| + |torque| h) / I_min: nearly always that is enough
  const double momentum =
      states_[body].angular_momentum_world.norm() + disturbance.torque * duration;
  if (!measures_path &&
      (1.0 + kUnder) * momentum * duration <= kMostTurnInStep * principal_of(body).moments[0])
    return duration;
  const double speed =
      bound_rotation(states_[body], world_.bodies[body].inertia, principal_of(body), disturbance)
          .angular_speed;
  if (!measures_path && speed * duration <= kMostTurnInStep) return duration;
  const double turning_little = std::min(duration, (1.0 - kUnder) * kMostTurnInStep / speed);
  double resolved = turning_little;
  for (int halvings = 0; !bound_turning(body, resolved, bounds); ++halvings, resolved *= 0.5)
    if (halvings == kMostHalvings) return turning_little;
  return resolved;
}

// A ball that nothing hangs on looks the same however it turns, and moves the same: to turn it
// wrong is no fault. (One that is not round inside moves as it is turned, where it rubs.)
void MovingWorld::note_turning(int body, double found, RunWatch::Kind kind, double duration) {
  const bool is_tied =
      linked_group(body) >= 0 ||
      std::any_of(effects::all().begin(), effects::all().end(), [&](const effects::Effect* effect) {
        return effect->traits().stores_energy && effect->count_in(world_) > 0;
      });
  if (!is_tied && flies_freely(body)) return;
  const Vector3d& moments = principal_of(body).moments;
  const bool is_round = shapes_[body]->is_ball() && moments.maxCoeff() - moments.minCoeff() <=
                                                        kSameMoments * moments.maxCoeff();
  if (is_tied || !is_round) {
    const double allowed = kind == RunWatch::Kind::kTurnUnresolved ? kTurnResolved : kTurnsRight;
    return counters_.watch.note(kind, names_of(world_, {body}), {found, allowed, time_, duration});
  }
  const std::string ball = fmt::format("ball '{}'", world_.bodies[body].name);
  counters_.watch.say(
      ball, time_,
      fmt::format("{} {}: its orientation is not to be trusted, how it moves is", ball,
                  kind == RunWatch::Kind::kTurnUnresolved
                      ? "turns more than half a turn in a step"
                      : fmt::format("is turned wrong by {:.2g} rad by its steps", found)));
}

// Beyond half a turn a step cannot be told from a turn the other way round: a method of integration
// that samples it only there gives some orientation. Below it gives one that is off by its order.
void MovingWorld::watch_turning(int body, const RigidBodyState& end, double duration) {
  if (!can_move(body)) return;
  const double speed = turning_speed_of(states_[body], world_.bodies[body].inertia);
  if (speed * duration > kTurnResolved)
    return note_turning(body, speed * duration, RunWatch::Kind::kTurnUnresolved, duration);
  if (!watches_free_turning_ || speed == 0.0 || linked_group(body) >= 0 || paths_[body].smooth ||
      !is_left_alone(body))
    return;
  FreeTurning& turning = free_turning_.try_emplace(body, world_.bodies[body].inertia).first->second;
  turning.step(states_[body], end, duration, speed);
  if (turning.error() > kTurnsRight)
    note_turning(body, turning.error(), RunWatch::Kind::kTurnsWrong, turning.longest_step());
}

bool MovingWorld::shorten_step(const std::vector<std::pair<int, int>>& pairs,
                               const std::function<bool(std::pair<int, int>)>& in_step) {
  enum class Need : char { kNothing, kTurning, kPath };
  std::vector<Need> needs(size(), Need::kNothing);
  for (const auto& pair : pairs) {
    const Need need = in_step && in_step(pair) ? Need::kTurning : Need::kPath;
    for (const int body : {pair.first, pair.second}) needs[body] = std::max(needs[body], need);
  }
  constexpr const char* kTooFar =
      ", too far to find its collisions: make the step (\"step_s\") shorter or the body slower";
  const double asked = target_ - time_;
  const auto turning_of = [&](int body, double step) {
    return fmt::format("body '{}' turns {:.3g} rad a step of {} s", world_.bodies[body].name,
                       omega_of(states_[body], world_.bodies[body].inertia).norm() * step,
                       step_in_words(step));
  };
  double duration = asked;
  int fastest = -1;
  for (int body = 0; body < size(); ++body) {
    // however a ball turns, it looks the same
    if (needs[body] == Need::kNothing || !can_move(body) || shapes_[body]->is_ball()) continue;
    // its bounds are exact at any length, but a search goes by them a radian at a time
    if (paths_[body].smooth) {
      if (omega_of(states_[body], world_.bodies[body].inertia).norm() * asked >
          kMostTurning * kMostTurnInStep)
        throw StoppedRun(turning_of(body, asked) + kTooFar);
      continue;
    }
    const double resolved = resolved_duration(body, duration, needs[body] == Need::kPath);
    if (resolved < duration) fastest = body;
    duration = resolved;
  }
  if (fastest < 0) return false;
  const std::string turns = turning_of(fastest, asked);
  if (asked > kMostTurning * duration) throw StoppedRun(turns + kTooFar);
  counters_.watch.say(
      fmt::format("steps of '{}'", world_.bodies[fastest].name), time_,
      fmt::format("step shortened: {}; where it may meet another body it gets steps of {:.2g} s, "
                  "so that no collision is missed",
                  turns, duration));
  ++counters_.shortened_steps;
  begin_step_again(time_ + duration);
  return true;
}

}  // namespace tumble::engines
