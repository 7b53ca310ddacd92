/// An independent judgement of a recorded run: energy from nowhere, overlapping bodies, open
/// joints, values that are not finite. Computed from positions and velocities in the frames and
/// from the scene alone, without the run's own energies, gaps and checks.
#pragma once

#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::fuzz {

/// One impossible result.
struct Fault {
  std::string kind;   // one word: "energy", "overlap", "open", "number", "short"
  std::string words;  // value, place and time, with units
};

/// The worst fault of each kind; empty for a run without faults.
std::vector<Fault> faults_of(const scene::Scene& scene, const Trajectory& run);

}  // namespace tumble::fuzz
