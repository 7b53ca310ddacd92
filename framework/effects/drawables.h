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

/// A point of a body, by the body's name, or of the world (an empty name).
struct DrawnPoint {
  std::string body;
  Vector3d point;              // body frame, or world [m]
};

/// A coil between two points: a spring.
struct DrawnCoil {
  std::string name;
  DrawnPoint a, b;
  double rest_length;          // at which its turns stand close [m]
};

struct Drawables {
  std::vector<DrawnCoil> coils;
  std::vector<DrawnArrow> arrows;
};

}  // namespace tumble::effects
