#include "framework/effects/motor/acting_motors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "framework/effects/joint/joint_rows.h"

namespace tumble::effects {
namespace {

// of the largest torque: what the rates of bodies at rest change in it
constexpr double kSameTorque = 1e-6;
constexpr double kTurn = 2 * std::numbers::pi;  // rad
constexpr double kSameAngle = 1e-9;             // rad: likewise, by a motor's stiffness

// A motor measures its hinge's angle within a turn: from half a turn between two looks on it is
// lost. Nothing comes so far that does not overshoot more each time, because the torque that brakes
// it is held for too long.
void refuse_lost(const std::string& hinge, const MotorSpec& law, const HingeMotion& motion) {
  const double turn = std::abs(motion.rate) * law.period_s;
  if (law.stiffness_n_m_rad == 0.0 || !(turn > std::numbers::pi)) return;
  throw StoppedRun(
      fmt::format("the motor of '{}' finds its hinge turning at {:.3g} rad/s, {:.3g} rad between "
                  "two looks {:.3g} s apart: beyond half a turn it does not know its angle. "
                  "Likely it overshoots more each time, for it holds its torque too long: a "
                  "shorter \"period_s\", or less \"damping_n_m_s_rad\" or \"stiffness_n_m_rad\"",
                  hinge, motion.rate, turn, law.period_s));
}

// Of the work that passes through motors: as much is granted besides.
constexpr double kGranted = 1e-2;

}  // namespace

void set_anew(const MotorSpec& law, double time, const HingeMotion& hinge, MotorHold& held) {
  // The hinge knows its angle within a turn, the motor how far it has come: since the last look by
  // less than half a turn (refuse_lost).
  const double turns = held.next_look > 0.0 ? std::round((held.angle - hinge.angle) / kTurn) : 0.0;
  held.angle = hinge.angle + kTurn * turns;
  const double target =
      law.offset_rad +
      law.amplitude_rad * std::sin(kTurn * law.frequency_hz * time + law.phase_rad);
  const double torque =
      law.stiffness_n_m_rad * (target - held.angle) - law.damping_n_m_s_rad * hinge.rate;
  held.torque = std::clamp(torque, -law.largest_torque_n_m, law.largest_torque_n_m);
  held.next_look = law.period_s * (std::floor(time / law.period_s * (1 + 1e-12)) + 1);
}

MotorTerms::MotorTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places)
    : calls_(acting.calls), all_(acting.world.effects.of<Motor>()) {
  for (const int entry : entries) {
    const JointLink& hinge = all_[static_cast<std::size_t>(entry)].hinge;
    const int a = places.place_of(hinge.a.body);
    motors_.push_back({entry, a, places.place_of(hinge.b.body)});
  }
}

void MotorTerms::add_forces(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) {
  for (const Acts& motor : motors_) {
    const HingeMotion hinge = hinge_motion(of(motor).hinge, bodies[motor.a], bodies[motor.b]);
    wrenches[motor.b].torque_world += motor.held.torque * hinge.axis_world;
    wrenches[motor.a].torque_world -= motor.held.torque * hinge.axis_world;
  }
}

double MotorTerms::look(double time, const std::vector<Body>& bodies) {
  double next = std::numeric_limits<double>::infinity();
  for (Acts& motor : motors_) {
    const MotorSpec& law = of(motor).law;
    if (time >= motor.held.next_look) {
      ++calls_;
      const HingeMotion hinge = hinge_motion(of(motor).hinge, bodies[motor.a], bodies[motor.b]);
      refuse_lost(of(motor).hinge.name, law, hinge);
      set_anew(law, time, hinge, motor.held);
    }
    next = std::min(next, motor.held.next_look);
  }
  return next;
}

Memory MotorTerms::memory() const {
  Memory memory;
  for (const Acts& motor : motors_)
    memory[motor.entry] = {motor.held.torque, motor.held.next_look, motor.held.angle};
  return memory;
}

void MotorTerms::remember(const Memory& memory) {
  for (Acts& motor : motors_) {
    const auto held = memory.find(motor.entry);
    motor.held = held == memory.end()
                     ? MotorHold{}
                     : MotorHold{held->second[0], held->second[1], held->second[2]};
  }
}

void MotorTerms::look_again() {
  for (Acts& motor : motors_)
    if (motor.held.next_look > 0.0)  // it knows how many turns it has come
      motor.held.next_look = std::numeric_limits<double>::min();
}

bool MotorTerms::differs_from(const Memory& before) const {
  double largest = 0.0, stiffest = 0.0, change = 0.0;
  for (const Acts& motor : motors_) {
    stiffest = std::max(stiffest, of(motor).law.stiffness_n_m_rad);
    const auto held = before.find(motor.entry);
    const double torque = held == before.end() ? 0.0 : held->second[0];
    largest = std::max(largest, std::abs(torque));
    change = std::max(change, std::abs(motor.held.torque - torque));
  }
  return change > kSameTorque * largest + kSameAngle * stiffest;
}

void MotorMeter::add_work(double time, const std::vector<RigidBodyState>& states,
                          std::vector<Work>& brought) {
  const std::vector<Motor>& motors = world_.effects.of<Motor>();
  // What of a body its hinge's motion asks for: how it stands and turns.
  const auto body = [&](int index) {
    Body found{infinite_inertia(), Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
               Vector3d::Zero()};
    if (index < 0) return found;
    const WorldBody& held = world_.bodies[static_cast<std::size_t>(index)];
    const RigidBodyState& state = states[static_cast<std::size_t>(index)];
    found.world_from_body = state.world_from_body;
    if (!held.immovable()) found.omega_world = omega_of(state, held.inertia);
    return found;
  };
  motors_.resize(motors.size());  // entries may have been appended
  const double passed = time - std::exchange(last_look_, time);
  for (std::size_t k = 0; k < motors.size(); ++k) {
    Metered& motor = motors_[k];
    const JointLink& link = motors[k].hinge;
    const HingeMotion hinge = hinge_motion(link, body(link.a.body), body(link.b.body));
    if (!std::isnan(motor.angle)) {
      const bool turns_a =
          link.a.body >= 0 && !world_.bodies[static_cast<std::size_t>(link.a.body)].immovable();
      Work& work = brought[static_cast<std::size_t>(turns_a ? link.a.body : link.b.body)];
      // whole turns by the mean rate
      const double about = 0.5 * (motor.rate + hinge.rate) * passed;
      const double turned = about + std::remainder(hinge.angle - motor.angle - about, kTurn);
      work.done += motor.held.torque * turned;
      work.most += kGranted * std::abs(motor.held.torque * turned);
      if (std::abs(about) > 0.5 * kTurn) work.most += std::abs(motor.held.torque * about);
    }
    motor.angle = hinge.angle;
    motor.rate = hinge.rate;
    if (time >= motor.held.next_look) set_anew(motors[k].law, time, hinge, motor.held);
  }
}

}  // namespace tumble::effects
