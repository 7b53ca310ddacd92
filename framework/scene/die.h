/// The pips of a die, which are drawn only: no law looks at them.
#pragma once

#include <vector>

#include "framework/core/math.h"

namespace tumble::scene {

/// A disc on a body's surface. Body frame, metres.
struct Pip {
  Vector3d point_body;
  Vector3d normal_body;  // outward, unit
  double radius_m;
};

/// Six on +z, one on -z; two on +x, five on -x; three on -y, four on +y: opposite faces make seven,
/// and one, two, three run counter-clockwise about their corner, as on a European die.
std::vector<Pip> pips_of_die(const Vector3d& half_extents_body);

}  // namespace tumble::scene
