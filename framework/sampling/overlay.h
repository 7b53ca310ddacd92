/// Several runs of one scene in one picture: what cannot move once, what moves once for each run.
#pragma once

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::sampling {

struct Overlay {
  scene::Scene scene;
  Trajectory run;
};

/// One run that is drawn with others.
struct OverlaidRun {
  Trajectory run;
  Vector3d color;  // linear RGB in [0, 1], of what moves
};

/// @param runs  of worlds of the scene, at least one, with frames at the same times; the first
///   one's bodies keep their names, those of others get a number
Overlay overlay_of(const scene::Scene& scene, const std::vector<OverlaidRun>& runs);

}  // namespace tumble::sampling
