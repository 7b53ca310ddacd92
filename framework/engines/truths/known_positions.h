/// Where a scene's bodies have to be, by a truth file about the same problem.
#pragma once

#include <vector>

#include "framework/engines/truths/truth_case.h"
#include "framework/scene/scene.h"

namespace tumble::truths {

struct KnownPlace {
  double time_s;
  std::size_t body;           // of the scene
  Vector3d com_world;         // [m]
};

/// Families chain and double_pendulum (a scene of point masses on rods in the x-z plane, released from rest) and bouncing_ball (one ball above a
/// plane). The scene is the same problem where masses, lengths, places, speeds and gravity are, to a rounding or two.
/// @return by time, then body; nothing where the case is about something else
std::vector<KnownPlace> known_places(const scene::Scene& scene, const Case& truth);

}  // namespace tumble::truths
