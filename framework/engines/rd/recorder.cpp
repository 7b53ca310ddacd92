#include "framework/engines/rd/recorder.h"

#include <algorithm>
#include <limits>

#include "framework/effects/invariants.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/sleeping.h"

namespace tumble::engines {
namespace {

// No pair whose gap is at least `smallest` changes it, and the balls around the two decide most.
double smaller_gap(const MovingWorld& moving, const std::vector<RigidBodyState>& states, int i,
                   int j, double smallest) {
  if (!moving.may_collide(i, j)) return smallest;
  const collision::CollisionShape& a = moving.shape(i);
  const collision::CollisionShape& b = moving.shape(j);
  if (!a.is_half_space() && !b.is_half_space()) {
    const double reach = smallest + a.bounding_radius() + b.bounding_radius();
    if ((states[i].com_world - states[j].com_world).squaredNorm() > reach * reach) return smallest;
  }
  const auto pose = [&](int k) {
    return collision::Pose{states[k].com_world, states[k].world_from_body};
  };
  return std::min(
      smallest, collision::gap_distance(a, pose(i), b, pose(j), moving.pair_cache(i, j), smallest));
}

}  // namespace

void SmallestGap::sort_bodies(const MovingWorld& moving) {
  for (int i = 0; i < moving.size(); ++i) {
    const WorldBody& body = moving.world().bodies[i];
    if (!body.collides) continue;
    (body.passes_movable && !body.immovable() ? meets_others_ : meets_all_).push_back(i);
  }
}

double SmallestGap::measure(const MovingWorld& moving, const std::vector<RigidBodyState>& states) {
  if (meets_all_.empty() && meets_others_.empty()) sort_bodies(moving);
  std::vector<char> still(moving.size());
  for (int i = 0; i < moving.size(); ++i)
    still[i] = moving.asleep(i) || (moving.world().bodies[i].immovable() && !moving.is_driven(i));
  const auto over_pairs = [&](double smallest, bool of_still) {
    const auto look = [&](int i, int j) {
      if ((still[i] && still[j]) == of_still)
        smallest = smaller_gap(moving, states, std::min(i, j), std::max(i, j), smallest);
    };
    for (std::size_t k = 0; k < meets_all_.size(); ++k) {
      for (std::size_t l = k + 1; l < meets_all_.size(); ++l) look(meets_all_[k], meets_all_[l]);
      for (const int other : meets_others_) look(meets_all_[k], other);
    }
    return smallest;
  };
  if (still != still_) {
    still_gap_ = over_pairs(std::numeric_limits<double>::infinity(), true);
    still_ = still;
  }
  return over_pairs(still_gap_, false);
}

void FrameRecorder::push(MovingWorld& moving, double t) {
  std::vector<RigidBodyState> states;
  for (int i = 0; i < moving.size(); ++i)
    states.push_back(t == moving.time() && moving.can_move(i) ? moving.state(i)
                                                              : moving.path(i, t));
  if (t > moving.time() && !moving.linked_groups().empty()) moving.close_links(states, t);
  if (built::kContact && contacts_ && t > moving.time())
    contacts_->remove_overlaps_within_step(states, t);
  Frame frame;
  frame.time = t;
  for (int i = 0; i < moving.size(); ++i) {
    const WorldBody& body = moving.world().bodies[i];
    BodyPose pose{states[i].com_world, states[i].world_from_body, moving.velocity_of(i, t),
                  Vector3d::Zero()};
    if (moving.can_move(i))
      pose.velocity_world = body.inertia.inverse_mass * states[i].momentum_world;
    if (!body.immovable()) pose.omega_world = omega_of(states[i], body.inertia);
    frame.poses.push_back(pose);
  }
  const Invariants sums = invariants_of(moving.world(), states);
  frame.kinetic_energy = sums.kinetic_energy;
  frame.potential_energy = sums.potential_energy;
  frame.momentum_world = sums.momentum_world;
  frame.angular_momentum_world = sums.angular_momentum_world;
  frame.smallest_gap = smallest_gap_.measure(moving, states);
  if (built::kContact && contacts_) frame.contacts = contacts_->forces();
  if (built::kSleep && sleepers_) sleepers_->append_forces(frame.contacts);
  record(moving.measure_links(states, t, frame.contacts), frame);
  sink_.frame(frame);
}

void FrameRecorder::record_before(MovingWorld& moving, double t) {
  for (; times_.next() < t; times_.take()) push(moving, times_.next());
}

void FrameRecorder::record_committed(MovingWorld& moving) {
  if (times_.next() > moving.time() + times_.slack()) return;
  push(moving, moving.time());
  times_.take();
}

}  // namespace tumble::engines
