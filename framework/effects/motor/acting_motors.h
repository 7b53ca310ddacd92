/// Motors at work: what those of a group hold, and when they look again. Internal to
/// framework/effects/motor.
#pragma once

#include <vector>

#include "framework/core/math.h"
#include "framework/effects/joint/joint_rows.h"
#include "framework/effects/linked_effect.h"
#include "framework/effects/motor/motor.h"

namespace tumble::effects {

/// What a motor holds from one look to the next.
struct MotorHold {
  double torque = 0.0;     // [N m]
  double next_look = 0.0;  // [s]; 0: it has not looked yet
  double angle = 0.0;      // of its hinge at its last look, whole turns counted [rad]
};

/// A motor's look at its hinge: the equation of motor.h, and when it looks next.
void set_anew(const MotorSpec& law, double time, const HingeMotion& hinge, MotorHold& held);

class MotorTerms final : public GroupTerms, public Control {
 public:
  MotorTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places);

  void add_forces(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) override;
  Control* control() override { return this; }

  double look(double time, const std::vector<Body>& bodies) override;
  Memory memory() const override;
  void remember(const Memory& memory) override;
  void look_again() override;
  bool differs_from(const Memory& before) const override;

 private:
  struct Acts {
    int entry;  // in the world's list
    int a, b;   // places of its hinge's bodies
    MotorHold held{};
  };
  const Motor& of(const Acts& motor) const { return all_[static_cast<std::size_t>(motor.entry)]; }

  std::uint64_t& calls_;
  const std::vector<Motor>& all_;
  std::vector<Acts> motors_;
};

/// The work that motors do, with a largest torque or without: each holds its torque between two
/// looks, so it does torque times how far its hinge turned, whatever turned it.
///   W = tau (angle_now - angle_before)
/// Exact where this is asked at each of a motor's looks and in the states that it sees there, as a
/// run by steps does; torques are found anew by set_anew. What is granted besides:
///   0.01 |W|    for what projection turns a hinge by and methods leave: the part that the watch
///               grants to all that a scene has to give (engines::kEnergyRises); a wrong step makes
///               more
///   |tau rate h|  where the hinge turned beyond half a turn: there its angle no longer says how
///               far, and the run says that (RunWatch::Kind::kTurnUnresolved)
/// A torque that is held for too long counts with what it really brings in: no fault of the step;
/// refuse_lost speaks of it.
class MotorMeter final : public WorkMeter {
 public:
  explicit MotorMeter(const World& world) : world_(world) {}
  void add_work(double time, const std::vector<RigidBodyState>& states,
                std::vector<Work>& brought) override;

 private:
  struct Metered {
    MotorHold held{};
    double angle = kUnset, rate = 0.0;  // of its hinge at the last look [rad], [rad/s]
  };

  const World& world_;
  std::vector<Metered> motors_;  // by entry of the world
  double last_look_ = 0.0;       // [s]
};

}  // namespace tumble::effects
