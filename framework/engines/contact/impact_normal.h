/// The normal of an impact where corner meets corner, or edge meets parallel edge.
///
/// More than one normal keeps such bodies apart, and nothing but a rounding decides which of them a
/// gap has. Two bodies that approach along each of them push each other along the middle, so that
/// what is symmetric stays so. The run says it: a shift of 1e-12 m gives one normal, and another
/// motion.
#pragma once

#include "framework/collision/gap.h"
#include "framework/collision/motion.h"
#include "framework/engines/base/run_watch.h"

namespace tumble::engines {

/// The subject of what is said (RunWatch::say).
inline constexpr const char* kNormalOfImpact = "normal of an impact";

/// Two bodies that an impulse acts between.
struct MeetingBodies {
  const WorldBody &a, &b;
  const collision::CollisionShape &shape_a, &shape_b;
  collision::MotionState motion_a, motion_b;
};

/// Along which an impact acts: the gap's normal, or the middle of several (unit, from B to A).
/// @param gap  theirs
/// @param threshold  they approach faster than this, or it is the gap's normal [m/s]
Vector3d normal_of_impact(const MeetingBodies& bodies, const collision::Gap& gap, double threshold);

/// Says once a run that an impact at t [s] had several normals.
/// @param gap  theirs  @param normal  of normal_of_impact
void watch_normal(double t, const MeetingBodies& bodies, const collision::Gap& gap,
                  const Vector3d& normal, RunWatch& watch);

}  // namespace tumble::engines
