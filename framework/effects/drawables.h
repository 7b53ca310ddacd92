/// What effects show of themselves, as plain data: pictures (render) and the page that plays a run (report) draw it alike.
#pragma once

#include <string>
#include <vector>

#include "framework/core/math.h"

namespace tumble::effects {

/// A force that pushes: an arrow whose head is at the point, which is fixed in the body.
struct DrawnArrow {
  std::string body;            // its name
  Vector3d force_world;        // [N]
  Vector3d point_world;        // where the point is at start_s [m]
  double start_s, duration_s;
};

struct Drawables {
  std::vector<DrawnArrow> arrows;
};

}  // namespace tumble::effects
