/// In what worlds of a scene may differ, and what is asked of their end: plain data of the scene
/// file's entry "sampling". A run of the scene knows nothing of it; framework/sampling makes
/// worlds of it.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "framework/core/math.h"

namespace tumble::scene {

inline constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// One number of one body, and what is believed of it.
struct PerturbationSpec {
  std::string body;
  // a word of scene.schema.json: "velocity_x_m_s", "restitution"; of "turn_x_rad" the number is an
  // angle by which the body is turned about the world's axis, on top of its orientation
  std::string what;
  bool is_normal = true;  // else uniform between low and high
  double mean = kUnset;   // of a normal one
  double deviation = kUnset;
  double low = -kNoBound, high = kNoBound;
  bool multiplies = false;  // proposals multiply it; else they add to it
  double step = kUnset;     // size of a proposal's step; of one that multiplies, of its logarithm
  std::string pointer;      // JSON pointer of its entry
};

/// What is asked of a body at the end of the run: the place of a point of it, or how an axis of it
/// leans.
struct AskedSpec {
  std::string body;
  bool is_place = true;
  Vector3d point_body = Vector3d::Zero();  // that has the place, from the centre of mass [m]
  Vector3d low_m = Vector3d::Constant(-kNoBound), high_m = Vector3d::Constant(kNoBound);  // world
  Vector3d axis_body = Vector3d::UnitZ();                                                 // unit
  Vector3d direction_world = Vector3d::UnitZ();                                           // unit
  double least_rad = 0.0, most_rad = kNoBound;  // between that axis and that direction
  double softness = kUnset;                     // of a violation [m] or [rad]
  std::string pointer;
};

struct SamplingSpec {
  std::vector<PerturbationSpec> perturbed;
  std::vector<AskedSpec> asked;  // all of it
  double wide_share = 0.15;      // of proposals that take wide steps
  double wide_factor = 6.0;      // and how wide
};

}  // namespace tumble::scene
