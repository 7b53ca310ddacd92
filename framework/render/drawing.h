/// What one picture holds, as plain data: what the stage says and the painter draws. Internal to framework/render.
///
/// World frame, metres; here numbers become `float`, and nowhere else.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "framework/render/camera.h"

namespace tumble::render {

struct Vertex {
  float position[3];   // local frame
  float normal[3];     // unit
};

/// Triangles, counter-clockwise seen from outside.
struct Geometry {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
};

/// How a thing is drawn.
enum class Pass : std::uint8_t {
  kSolid,      // lit; throws and receives shadow
  kGlass,      // lit, translucent, throws no shadow: a wall that stands between the eye and the action
  kLine,       // unlit, hidden behind bodies, throws no shadow: paths, the bar that shows the grid's scale
  kMark,       // on top of everything, unlit: arrows, flashes
};

struct Instance {
  float world_from_local[12];   // 3 x 4, row by row
  float color[4];               // linear RGB and opacity
  float quartered;              // 1: quarters of two tones, so that a ball's turning shows; 0: one tone
};

/// Instances of one geometry, drawn together.
struct Batch {
  int geometry;
  Pass pass;
  std::vector<Instance> instances;
};

/// The ground: a plane of constant z that fades out, with a grid.
struct Ground {
  bool shown = false;
  double height_m = 0.0;
  double spacing_m = 0.0;        // of the grid; 0: no grid
  Vector2d centre_m = Vector2d::Zero();
  double fade_m = 10.0;          // distance from the centre at which it is gone
};

struct Drawing {
  View view;
  double near_m = 0.1, far_m = 100.0;
  Vector3d to_light_world;                       // unit
  Vector3d shadow_centre_world;                  // of the ball whose shadows are drawn
  double shadow_radius_m = 1.0;
  Ground ground;
  std::vector<Batch> batches;
};

}  // namespace tumble::render
