/// Two runs of a random pile, compared: when, and by how much, its bodies part.
#pragma once

#include <string>

#include "framework/dynamics/laws.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::fuzz {

struct PileRun {
  std::string engine;
  double steps = 1.0;     // in one of the scene's
  double shift_m = 0.0;   // of the first body's start, along x
  double until_s = 0.75;  // how long it runs
};

inline constexpr double kPileFrames = 240.0;  // a second

Trajectory run_pile(const scene::Scene& pile, const Laws& laws, const PileRun& run);

/// How far the centres of a body are apart, at most, in the frame at this time; NaN where a run has
/// none. [m]
double apart_at(const Trajectory& a, const Trajectory& b, double time);
/// The first frame in which they are farther apart than this; infinite: none. [s]
double parted_at(const Trajectory& a, const Trajectory& b, double distance);

}  // namespace tumble::fuzz
