/// Expected positions of a scene's bodies, from a file of reference values for the same problem.
#pragma once

#include <vector>

#include "framework/truths/truth_case.h"
#include "framework/scene/scene.h"

namespace tumble::truths {

struct KnownPosition {
  double time_s;
  std::size_t body;    // of the scene
  Vector3d com_world;  // [m]
};

/// Families chain and double_pendulum (point masses on rods in the x-z plane, released from rest)
/// and bouncing_ball (one ball above a plane). The scene is the same problem where masses, lengths,
/// positions, velocities and gravity agree to a rounding or two.
/// @return by time, then body; nothing where the case is another problem
std::vector<KnownPosition> known_positions(const scene::Scene& scene, const Case& truth);

}  // namespace tumble::truths
