/// Rod: keeps two points at a distance, without mass.
///   C = |p_a - p_b| - L = 0, its row by the law RodRow, its force by constraint_multipliers
#pragma once

#include <string>

#include "framework/dynamics/law_list.h"
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

/// The distance constraint between a point of A and a point of B (body frames).
struct RodRow {
  using Function = ConstraintRow(const Body& a, const Vector3d& point_a_body, const Body& b,
                                 const Vector3d& point_b_body, double length);
  static constexpr LawWords kWords{.function = "rod_row",
                                   .effect = "rods",
                                   .what = "the constraint of a rod",
                                   .assignment = "a3"};
};

/// What a world holds of it.
struct RodLink {
  std::string name;
  Anchor a, b;
  double length;  // [m]
};

}  // namespace tumble::effects
