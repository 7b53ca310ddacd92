/// Copies of one body on a lattice: gas in a box, balls of Pong, a wall of bricks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/scene/scene.h"

namespace tumble::scene {

struct RepeatSpec {
  // its position is the lattice's centre, its name the stem of the copies' names
  BodySpec body;
  std::array<int, 3> counts{1, 1, 1};  // along x, y, z
  Vector3d spacing_m = Vector3d::Zero();
  Vector3d jitter_m = Vector3d::Zero();  // largest random shift
  // in a random direction, added to the body's velocity
  double speed_m_s = 0.0;
  std::string directions = "all";  // "xy", "xz", "yz" or "all"
  std::uint64_t seed = 0;
  std::vector<Vector3d> colors;  // used in turn; empty: the body's
};

/// The copies, named NAME_1, NAME_2, ...; the same seed gives the same copies.
std::vector<BodySpec> write_out(const RepeatSpec& repeat);

}  // namespace tumble::scene
