/// What a run says of impacts where corner meets corner, or edge meets parallel edge.
///
/// More than one normal keeps such bodies apart, and nothing but a rounding decides along which the
/// impact acts: what is symmetric does not stay so, and a shift of 1e-12 m gives another motion.
#pragma once

#include "framework/collision/gap.h"
#include "framework/engines/base/run_watch.h"

namespace tumble::engines {

/// The subject of what is said (RunWatch::say).
inline constexpr const char* kNormalOfImpact = "normal of an impact";

/// Two bodies that an impulse acts between.
struct MeetingBodies {
  const WorldBody &a, &b;
  const collision::CollisionShape &shape_a, &shape_b;
  collision::Pose pose_a, pose_b;
};

/// Says once a run that an impact at t [s] had several normals.
/// @param gap  along whose normal it acts
void watch_normal(double t, const MeetingBodies& bodies, const collision::Gap& gap,
                  RunWatch& watch);

}  // namespace tumble::engines
