// Where a body is within a step, how fast, and what its path stays within: what the collision
// finding asks. Part of MovingWorld.
#include <algorithm>
#include <cmath>

#include "framework/engines/base/effects_built.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

const RigidBodyState& MovingWorld::path_end(int body) {
  Path& path = paths_[body];
  if (!path.end_known) {
    // first: a series for the whole step is made by the caller that asks for all of it
    path.end_known = true;
    path.end = integrate(body, target_ - time_, time_, path.start);
  }
  return path.end;
}

RigidBodyState MovingWorld::path(int body, double t) {
  if (!can_move(body)) return still_state(body, t);
  if (t == time_) return states_[body];
  Path& path = paths_[body];
  if (t == target_) return path_end(body);
  if (path.smooth) return path.smooth->at(t);
  if (t != path.memo_time) {
    path.memo = integrate(body, t - time_, time_, path.start);
    path.memo_time = t;
  }
  return path.memo;
}

collision::MotionState MovingWorld::motion_at(int body, double t) {
  if (can_move(body) && paths_[body].smooth && t <= target_) {
    collision::MotionState motion = paths_[body].smooth->motion_at(t);
    // of a smooth path, always known
    if (t == target_) motion.pose = {paths_[body].end.com_world, paths_[body].end.world_from_body};
    if (t == time_) motion.pose = {states_[body].com_world, states_[body].world_from_body};
    return motion;
  }
  const RigidBodyState state = path(body, t);
  collision::MotionState motion;
  motion.pose = {state.com_world, state.world_from_body};
  if (!can_move(body)) {
    motion.velocity_world = velocity_of(body, t);
    return motion;
  }
  // The rate of the path, which for a method of first order is not the state's momentum over the
  // mass.
  const Inertia& inertia = world_.bodies[body].inertia;
  motion.velocity_world = inertia.inverse_mass * states_[body].momentum_world +
                          (t - time_) * paths_[body].acceleration_world;
  if (!shapes_[body]->is_ball()) motion.omega_world = omega_of(state, inertia);
  return motion;
}

collision::Pose MovingWorld::pose_at(int body, double t) {
  if (t != time_ && t != target_) return motion_at(body, t).pose;
  const auto pose = [](const RigidBodyState& state) -> collision::Pose {
    return {state.com_world, state.world_from_body};
  };
  if (!can_move(body)) return pose(still_state(body, t));
  return pose(t == time_ ? states_[body] : path_end(body));
}

collision::MotionBounds MovingWorld::work_out_bounds(int body) {
  collision::MotionBounds bounds;
  const WorldBody& b = world_.bodies[body];
  if (asleep(body)) return bounds;
  if (!can_move(body)) {
    const scene::PrescribedMotion& m =
        b.immovable() ? b.motion : world_.bodies[rests_[body]->support].motion;
    bounds.acceleration_deviation =
        m.amplitude_m.norm() * m.angular_frequency_rad_s * m.angular_frequency_rad_s;
    return bounds;
  }
  if (paths_[body].smooth) return paths_[body].smooth->bounds();
  bounds.acceleration_world = paths_[body].acceleration_world;
  if (shapes_[body]->is_ball()) return bounds;  // however it turns, it looks the same
  bound_turning(body, target_ - time_, bounds);
  return bounds;
}

collision::Motion MovingWorld::motion(int body) {
  if (!paths_[body].bounds) paths_[body].bounds = work_out_bounds(body);
  return {[this, body](double t) { return motion_at(body, t); }, *paths_[body].bounds};
}

double MovingWorld::fastest_in_step(int body) {
  const collision::MotionState start = motion_at(body, time_), end = motion_at(body, target_);
  const double radius = shapes_[body]->is_half_space() ? 0.0 : shapes_[body]->bounding_radius();
  return std::max(start.velocity_world.norm(), end.velocity_world.norm()) +
         std::max(start.omega_world.norm(), end.omega_world.norm()) * radius;
}

collision::SweptBox MovingWorld::swept_box(int body) {
  if (has_roomy_box(body)) return *paths_[body].box;
  const double radius = shapes_[body]->bounding_radius();
  const double h = target_ - time_;
  const Vector3d start = path(body, time_).com_world, end = path(body, target_).com_world;
  // Between its ends a parabola leaves their box by at most a h^2 / 8; a shaken body by at most its
  // amplitude.
  Vector3d bulge = Vector3d::Zero();
  if (can_move(body) && paths_[body].smooth) {
    const collision::MotionBounds& bounds = paths_[body].smooth->bounds();
    bulge =
        (bounds.acceleration_world.cwiseAbs() + Vector3d::Constant(bounds.acceleration_deviation)) *
        (h * h / 8);
  } else if (can_move(body)) {
    bulge = paths_[body].acceleration_world.cwiseAbs() * (h * h / 8);
  } else {
    const int mover = resting(body) ? rests_[body]->support : body;
    const scene::PrescribedMotion& m = world_.bodies[mover].motion;
    bulge =
        m.amplitude_m.cwiseAbs() * std::min(1.0, std::pow(m.angular_frequency_rad_s * h, 2) / 8);
  }
  const double contact_margin =
      built::kContact && world_.contact && std::isfinite(radius) ? kNegligible * radius : 0.0;
  const Vector3d margin =
      bulge + Vector3d::Constant(radius + contact_margin) +
      kCoordinateRounding * (start.cwiseAbs() + end.cwiseAbs() +
                             Vector3d::Constant(std::isfinite(radius) ? radius : 0.0));
  const collision::SweptBox box{start.cwiseMin(end) - margin, start.cwiseMax(end) + margin,
                                can_move(body) || is_driven(body)};
  // contacts begin steps again
  if (built::kContact && world_.contact && can_move(body) && !paths_[body].smooth) {
    paths_[body].box = box;
    paths_[body].box_target = target_;
  }
  return box;
}

}  // namespace tumble::engines
