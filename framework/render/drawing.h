/// The content of one picture as plain data, from the stage to the painter. Internal to
/// framework/render.
///
/// World frame, metres. Only here numbers are converted to `float`, after the drawing's origin has
/// been subtracted.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "framework/render/camera.h"

namespace tumble::render {

struct Vertex {
  float position[3];  // local frame
  float normal[3];    // unit

  bool operator==(const Vertex&) const = default;
};

/// Triangles, counter-clockwise seen from outside.
struct Geometry {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;

  bool operator==(const Geometry&) const = default;
};

/// How an object is drawn.
enum class Pass : std::uint8_t {
  kSolid,  // lit; casts and receives shadow
  kGlass,  // lit, translucent, casts no shadow: a wall between the eye and moving bodies
  kLine,   // unlit, occluded by bodies, casts no shadow: paths, the scale bar of the grid
  kMark,   // unlit, in front of everything: arrows, flashes
};

struct Instance {
  float world_from_local[12];  // 3 x 4, row by row; its last column from the drawing's origin
  float color[4];              // linear RGB and opacity
  // 1: quarters in two tones, so that the rotation of a ball is visible; 0: one tone
  float quartered;

  bool operator==(const Instance&) const = default;
};

/// Instances of one geometry, drawn together.
struct Batch {
  int geometry;
  Pass pass;
  std::vector<Instance> instances;

  bool operator==(const Batch&) const = default;
};

/// The ground: a plane of constant z with a grid, which fades out.
struct Ground {
  bool shown = false;
  double height_m = 0.0;
  double spacing_m = 0.0;  // of the grid; 0: no grid
  Vector2d centre_m = Vector2d::Zero();
  double fade_m = 10.0;  // distance from the centre at which it has faded out

  bool operator==(const Ground&) const = default;
};

/// Equal drawings of equal geometries give equal pictures.
struct Drawing {
  View view;
  // Near what is looked at where that is far from the world's origin, so that single precision is
  // enough; else zero.
  Vector3d origin_world = Vector3d::Zero();
  double near_m = 0.1, far_m = 100.0;
  Vector3d to_light_world;       // unit
  Vector3d shadow_centre_world;  // centre of the ball within which shadows are cast
  double shadow_radius_m = 1.0;
  Ground ground;
  std::vector<Batch> batches;

  /// Axes of the world.
  Vector3d from_origin(const Vector3d& point_world) const { return point_world - origin_world; }
  bool operator==(const Drawing&) const = default;
};

}  // namespace tumble::render
