/// Two runs of one scene: how far apart they are, and where they first differ.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::report {

/// The first thing that is not the same in both.
struct Difference {
  double time_s;
  std::string what;   // a sentence: "Collision of ball and wall: impulse 6 N s in submission, 9 N s in reference"
  int body = -1;      // -1: none in particular
};

struct Comparison {
  std::vector<double> apart_m;         // by frame of the first run: how far any point of any body is at most from where the other run has it; NaN where the other has no such frame
  std::optional<Difference> first;     // none: the same to round-off
};

/// Bodies differ where a point of one is `kApart` of the sight (eye to what it looks at) from its place in the other run, events where
/// kind or bodies do, or time or impulse do by more than `kEventShare` of themselves.
inline constexpr double kApart = 1e-6;        // a thousandth of a pixel, and a million times the round-off of a short run
inline constexpr double kEventShare = 1e-6;

/// @pre both runs are of the scene, with its bodies
/// @param radius_m  by body: of a ball about its origin that holds it; infinite for planes
Comparison compare(const scene::Scene& scene, const std::vector<double>& radius_m, const Trajectory& a, const std::string& label_a, const Trajectory& b,
                   const std::string& label_b);

/// "collision", "comes to rest", ...: an event in a list.
const char* name_of_event(EventKind kind);

}  // namespace tumble::report
