#include "framework/effects/point_force/acting_point_forces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/core/numbers.h"

namespace tumble::effects {

Switch switch_of(const PointForce& force, int entry, bool on, double time) {
  const double size = force.force_world.norm();
  const Vector3d direction = size > 0 ? Vector3d(force.force_world / size) : Vector3d::UnitZ();
  return {entry,
          on,
          {time, on ? EventKind::kForceOn : EventKind::kForceOff, force.body, -1, force.point_world,
           direction, 0.0, 0.0}};
}

void ActingPointForces::add(int body, const RigidBodyState& state, Wrench& sum) {
  for (const int entry : active_) {
    const PointForce& force = forces_[static_cast<std::size_t>(entry)];
    if (force.body != body) continue;
    ++calls_;
    const Vector3d point_world =
        state.com_world +
        state.world_from_body.normalized() * points_body_[static_cast<std::size_t>(entry)];
    const Wrench wrench =
        laws_.wrench_of_point_force(force.force_world, point_world, state.com_world);
    sum.force_world += wrench.force_world;
    sum.torque_world += wrench.torque_world;
  }
}

void ActingPointForces::add_acceleration(int body, Vector3d& sum_world) const {
  for (const int entry : active_) {
    const PointForce& force = forces_[static_cast<std::size_t>(entry)];
    if (force.body == body)
      sum_world +=
          world_.bodies[static_cast<std::size_t>(body)].inertia.inverse_mass * force.force_world;
  }
}

double ActingPointForces::work(int body, const RigidBodyState& from,
                               const RigidBodyState& to) const {
  double sum = 0.0;
  for (const int entry : active_) {
    const PointForce& force = forces_[static_cast<std::size_t>(entry)];
    const Vector3d& point_body = points_body_[static_cast<std::size_t>(entry)];
    if (force.body == body)
      sum += force.force_world.dot(to.com_world + to.world_from_body * point_body - from.com_world -
                                   from.world_from_body * point_body);
  }
  return sum;
}

// |r x F| <= |r| |F|
double ActingPointForces::torque_bound(int body) const {
  double bound = 0.0;
  for (const int entry : active_) {
    const PointForce& force = forces_[static_cast<std::size_t>(entry)];
    if (force.body == body)
      bound += force.force_world.norm() * points_body_[static_cast<std::size_t>(entry)].norm();
  }
  return bound;
}

bool ActingPointForces::leaves_flight(int body) const {
  return std::none_of(active_.begin(), active_.end(), [&](int entry) {
    return forces_[static_cast<std::size_t>(entry)].body == body;
  });
}

std::vector<Switch> ActingPointForces::due(double time) const {
  std::vector<Switch> due;
  for (int entry = 0; entry < static_cast<int>(forces_.size()); ++entry) {
    const PointForce& force = forces_[static_cast<std::size_t>(entry)];
    const bool is_on = std::find(active_.begin(), active_.end(), entry) != active_.end();
    const bool should_be_on = time >= force.start && time < force.end;
    if (is_on != should_be_on) due.push_back(switch_of(force, entry, should_be_on, time));
  }
  return due;
}

void ActingPointForces::turn(const Switch& what, const std::vector<RigidBodyState>& states) {
  if (!what.on) {
    active_.erase(std::remove(active_.begin(), active_.end(), what.entry), active_.end());
    return;
  }
  take_hold(what.entry, states);
  active_.push_back(what.entry);
}

void ActingPointForces::take_hold(int entry, const std::vector<RigidBodyState>& states) {
  const PointForce& force = forces_[static_cast<std::size_t>(entry)];
  const RigidBodyState& state = states[static_cast<std::size_t>(force.body)];
  points_body_.resize(forces_.size(), unset_vector());  // entries may have been appended
  points_body_[static_cast<std::size_t>(entry)] =
      state.world_from_body.conjugate() * (force.point_world - state.com_world);
}

double ActingPointForces::stand_at(double time, const Memory& memory,
                                   const std::vector<RigidBodyState>& states) {
  double next = std::numeric_limits<double>::infinity();
  active_.clear();
  for (int entry = 0; entry < static_cast<int>(forces_.size()); ++entry) {
    const PointForce& force = forces_[static_cast<std::size_t>(entry)];
    for (const double change : {force.start, force.end})
      if (change > time) next = std::min(next, change);
    if (!(time >= force.start && time < force.end)) continue;
    active_.push_back(entry);
    const auto held = memory.find(entry);
    if (held == memory.end())
      take_hold(entry, states);
    else
      points_body_[static_cast<std::size_t>(entry)] =
          Eigen::Map<const Vector3d>(held->second.data());
  }
  return next;
}

Memory ActingPointForces::memory() const {
  Memory memory;
  for (const int entry : active_) {
    const Vector3d& point_body = points_body_[static_cast<std::size_t>(entry)];
    memory[entry] = {point_body.x(), point_body.y(), point_body.z()};
  }
  return memory;
}

void PointForceMeter::add_work(double time, const std::vector<RigidBodyState>& states,
                               std::vector<Work>& brought) {
  points_body_.resize(forces_.size(), unset_vector());  // entries may have been appended
  points_world_.resize(forces_.size(), unset_vector());
  begins_unseen_.resize(forces_.size(), false);
  const double last = std::exchange(last_look_, time);
  for (std::size_t k = 0; k < forces_.size(); ++k) {
    const PointForce& force = forces_[k];
    if (time < force.start || force.end <= last) continue;
    const RigidBodyState& state = states[static_cast<std::size_t>(force.body)];
    Work& work = brought[static_cast<std::size_t>(force.body)];
    if (std::isnan(points_body_[k].x())) {
      points_body_[k] = state.world_from_body.conjugate() * (force.point_world - state.com_world);
      begins_unseen_[k] = last < force.start && force.start < time;
    }
    const Vector3d now = state.com_world + state.world_from_body * points_body_[k];
    if (begins_unseen_[k] || force.end < time)
      work.most = kInfinity;
    else if (!std::isnan(points_world_[k].x()))
      work.done += force.force_world.dot(now - points_world_[k]);
    points_world_[k] = now;
  }
}

}  // namespace tumble::effects
