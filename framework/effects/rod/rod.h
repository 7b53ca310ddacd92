/// Rod: keeps two points at a distance, without mass.
///   C = |p_a - p_b| - L = 0, its row by the law rod_row, its force by constraint_multipliers
#pragma once

#include <string>

#include "framework/dynamics/world.h"

namespace tumble::effects {

/// What a scene says of it.
struct RodSpec {
  std::string name;
  scene::AnchorSpec a, b;
  double length_m = kUnset;  // of a file that leaves it out: the distance at the start
  // JSON pointer of the entry that asked for it, for messages; empty: made in memory
  std::string pointer{};
};

/// What a world holds of it.
struct RodLink {
  std::string name;
  Anchor a, b;
  double length;  // [m]
};

}  // namespace tumble::effects
