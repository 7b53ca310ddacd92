/// Spring: a damped spring without mass between two points.
///   F on A = what the law spring_force says,    on B its opposite,    E = k/2 (L - L0)^2
#pragma once

#include <string>

#include "framework/dynamics/constraint.h"
#include "framework/dynamics/world.h"

namespace tumble::effects {

/// What a scene says of it.
struct SpringSpec {
  std::string name;
  scene::AnchorSpec a, b;
  double stiffness_n_m = kUnset;
  double damping_n_s_m = 0.0;
  double rest_length_m = kUnset;  // of a file that leaves it out: the distance at the start
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// What a world holds of it.
struct SpringLink {
  std::string name;
  Anchor a, b;
  Spring spring;
};

}  // namespace tumble::effects
