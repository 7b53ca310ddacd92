/// Motors at work: what those of a group hold, and when they look again. Internal to
/// framework/effects/motor.
#pragma once

#include "framework/effects/linked_effect.h"
#include "framework/effects/motor/motor.h"

namespace tumble::effects {

class MotorTerms final : public GroupTerms, public Control {
 public:
  MotorTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places);

  void add_forces(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) override;
  Control* control() override { return this; }

  double look(double time, const std::vector<Body>& bodies) override;
  Memory memory() const override;
  void remember(const Memory& memory) override;
  bool differs_from(const Memory& before) const override;

 private:
  struct Acts {
    int entry;               // in the world's list
    int a, b;                // places of its hinge's bodies
    double torque = 0.0;     // that it holds [N m]
    double next_look = 0.0;  // [s]; 0: it has not looked yet
    double angle = 0.0;      // of its hinge at its last look, whole turns counted [rad]
  };
  const Motor& of(const Acts& motor) const { return all_[static_cast<std::size_t>(motor.entry)]; }

  std::uint64_t& calls_;
  const std::vector<Motor>& all_;
  std::vector<Acts> motors_;
};

/// The most that motors can do: their largest torque over how far the hinge turned at the faster of
/// its rates at two looks, twice for what lies between.
class MotorMeter final : public WorkMeter {
 public:
  explicit MotorMeter(const World& world)
      : world_(world), turning_(world.effects.of<Motor>().size(), 0.0) {}
  Work since_last(double time, const std::vector<RigidBodyState>& states) override;
  bool is_unlimited() const override;

 private:
  const World& world_;
  std::vector<double> turning_;  // of each motor's hinge at the last look [rad/s]
  double last_look_ = 0.0;       // [s]
};

}  // namespace tumble::effects
