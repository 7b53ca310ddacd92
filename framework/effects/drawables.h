/// What effects show of themselves, as plain data: pictures (render) and the page that plays a run
/// (report) draw it alike.
#pragma once

#include <string>
#include <vector>

#include "framework/core/math.h"

namespace tumble::effects {

/// A force that pushes: an arrow whose head is at the point, which is fixed in the body.
struct DrawnArrow {
  std::string body;      // its name
  Vector3d force_world;  // [N]
  Vector3d point_world;  // where the point is at start_s [m]
  double start_s, duration_s;
};

/// A point of a body, by the body's name, or of the world (an empty name).
struct DrawnPoint {
  std::string body;
  Vector3d point;  // body frame, or world [m]
};

/// A coil between two points: a spring.
struct DrawnCoil {
  std::string name;
  DrawnPoint a, b;
  double rest_length;  // at which its turns stand close [m]
};

/// A bar between two points: a rod.
struct DrawnBar {
  std::string name;
  DrawnPoint a, b;
};

/// Where two bodies turn about each other: a small ball, or a pin along an axis. A weld is not
/// drawn, but is reported.
struct DrawnPivot {
  std::string name;
  enum class Kind { kBall, kPin, kWeld } kind;
  std::string body_a, body_b;        // names; empty: the world
  Vector3d point_world, axis_world;  // at the start, fixed in body_a [m], unit
};

/// A level sheet that one sees through: a surface of something that bodies lie in.
struct DrawnSheet {
  double height_m;  // z
  Vector3d color;   // linear RGB
};

struct Drawables {
  std::vector<DrawnCoil> coils;
  std::vector<DrawnBar> bars;
  std::vector<DrawnPivot> pivots;
  std::vector<DrawnArrow> arrows;
  std::vector<DrawnSheet> sheets;
};

}  // namespace tumble::effects
