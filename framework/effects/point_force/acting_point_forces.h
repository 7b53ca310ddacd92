/// Point forces at work: which of a world's act now, and on which points of their bodies. Internal
/// to framework/effects/point_force.
#pragma once

#include "framework/effects/effect.h"
#include "framework/effects/point_force/point_force.h"

namespace tumble::effects {

/// Where a force begins or ends, as engines report it.
Switch switch_of(const PointForce& force, int entry, bool on, double time);

class ActingPointForces final : public SteadyForces {
 public:
  explicit ActingPointForces(const Acting& acting)
      : world_(acting.world),
        laws_(acting.laws),
        calls_(acting.calls),
        forces_(world_.effects.of<PointForce>()),
        points_body_(forces_.size(), unset_vector()) {}

  void add(int body, const RigidBodyState& state, Wrench& sum) override;
  void add_acceleration(int body, Vector3d& sum_world) const override;
  double work(int body, const RigidBodyState& from, const RigidBodyState& to) const override;
  double torque_bound(int body) const override;
  bool leaves_flight(int body) const override;

  std::vector<Switch> due(double time) const override;
  void turn(const Switch& what, const std::vector<RigidBodyState>& states) override;
  double stand_at(double time, const Memory& memory,
                  const std::vector<RigidBodyState>& states) override;
  Memory memory() const override;

 private:
  void take_hold(int entry, const std::vector<RigidBodyState>& states);

  const World& world_;
  const Laws& laws_;
  std::uint64_t& calls_;
  const std::vector<PointForce>& forces_;
  std::vector<int> active_;            // entries that act, in the order in which they began
  std::vector<Vector3d> points_body_;  // by entry, from when it begins to act: body frame [m]
};

/// The work that they do: force times the displacement of its point, exact between any two looks at
/// which it acts. Not known where one begins or ends between two looks, nor after that begin: which
/// point of the body it acts on is known of its state then.
class PointForceMeter final : public WorkMeter {
 public:
  explicit PointForceMeter(const World& world)
      : forces_(world.effects.of<PointForce>()),
        points_body_(forces_.size(), unset_vector()),
        points_world_(points_body_),
        begins_unseen_(forces_.size(), false) {}
  bool needs_steps() const override { return false; }
  void add_work(double time, const std::vector<RigidBodyState>& states,
                std::vector<Work>& brought) override;

 private:
  const std::vector<PointForce>& forces_;
  // by entry: where it acts, and where that was at the last look [m]
  std::vector<Vector3d> points_body_, points_world_;
  std::vector<bool> begins_unseen_;  // by entry: between two looks
  double last_look_ = kUnset;        // [s]
};

}  // namespace tumble::effects
