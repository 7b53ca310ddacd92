/// What a recorded run shows to somebody who does not believe the program: energy from nowhere, bodies in each other, open joints,
/// numbers that are none. Worked out from places and velocities in the frames and from the scene alone; nothing that the run says of
/// itself (its energies, its gaps, its checks) is looked at.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::fuzz {

/// One thing that cannot be.
struct Fault {
  std::string kind;    // one word: "energy", "overlap", "open", "number", "short"
  std::string words;   // what was found, where and when, with units
};

/// The worst fault of each kind; empty for a run that may be right.
std::vector<Fault> faults_of(const scene::Scene& scene, const Trajectory& run);

}  // namespace tumble::fuzz
