#include "framework/engines/recorder.h"

#include <limits>

#include "framework/engines/sleeping.h"

namespace tumble::engines {

double smallest_gap(const MovingWorld& moving, const std::vector<RigidBodyState>& states) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < moving.size(); ++i) {
    for (int j = i + 1; j < moving.size(); ++j) {
      if (!moving.may_collide(i, j)) continue;
      const collision::CollisionShape& a = moving.shape(i);
      const collision::CollisionShape& b = moving.shape(j);
      if (!a.is_half_space() && !b.is_half_space()) {
        // No gap is smaller than that of the balls around the two.
        const double reach = smallest + a.bounding_radius() + b.bounding_radius();
        if ((states[i].com_world - states[j].com_world).squaredNorm() > reach * reach) continue;
      }
      const auto pose = [&](int k) { return collision::Pose{states[k].com_world, states[k].world_from_body}; };
      smallest = std::min(smallest, collision::compute_gap(a, pose(i), b, pose(j)).distance);
    }
  }
  return smallest;
}

void FrameRecorder::push(MovingWorld& moving, double t) {
  std::vector<RigidBodyState> states;
  for (int i = 0; i < moving.size(); ++i) states.push_back(t == moving.time() && moving.can_move(i) ? moving.state(i) : moving.path(i, t));
  Frame frame;
  frame.time = t;
  for (int i = 0; i < moving.size(); ++i) {
    const WorldBody& body = moving.world().bodies[i];
    BodyPose pose{states[i].com_world, states[i].world_from_body, moving.velocity_of(i, t), Vector3d::Zero()};
    if (moving.can_move(i)) pose.velocity_world = body.inertia.inverse_mass * states[i].momentum_world;
    if (!body.immovable()) pose.omega_world = omega_of(states[i], body.inertia);
    frame.poses.push_back(pose);
  }
  const Invariants sums = invariants_of(moving.world(), states);
  frame.kinetic_energy = sums.kinetic_energy;
  frame.potential_energy = sums.potential_energy;
  frame.momentum_world = sums.momentum_world;
  frame.angular_momentum_world = sums.angular_momentum_world;
  frame.smallest_gap = smallest_gap(moving, states);
  LinkForces forces = moving.measure_links(states, t);
  frame.spring_forces = std::move(forces.springs);
  frame.rod_tensions = std::move(forces.rods);
  frame.joint_forces = std::move(forces.joints);
  if (built::kContact && contacts_) frame.contacts = contacts_->forces();
  if (built::kSleep && sleepers_) sleepers_->append_forces(frame.contacts);
  sink_.frame(frame);
}

void FrameRecorder::record_before(MovingWorld& moving, double t) {
  for (; frame_time(next_) < t && frame_time(next_) <= duration_; ++next_) push(moving, frame_time(next_));
}

void FrameRecorder::record_committed(MovingWorld& moving) {
  if (frame_time(next_) <= duration_ && frame_time(next_) <= moving.time()) {
    push(moving, moving.time());
    ++next_;
  }
}

}  // namespace tumble::engines
