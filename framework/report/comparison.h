/// Two runs of one scene: how far apart they are, and where they first differ.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::report {

/// The first difference of two runs.
struct Difference {
  double time_s;
  // "collision of ball and wall: impulse 6 N s in submission, 9 N s in reference", "a force on box
  // begins only in submission"
  std::string what;
  int body = -1;  // -1: not of a particular body
};

/// One run ended, and the other went on: from there on nothing is compared.
struct EarlyEnd {
  double time_s;  // of its last frame
  bool is_first;  // of the two runs
};

struct Comparison {
  // by frame of the first run: largest distance of any point of any body from its place in the
  // other run; NaN where the other run has no such frame
  std::vector<double> apart_m;
  // none: equal to round-off, for as long as both ran
  std::optional<Difference> first;
  std::optional<EarlyEnd> early_end;
};

/// Bodies differ where a point of one is farther than `kApart`, relative to the distance of the
/// camera's target, from its place in the other run. Events differ in kind or bodies, or in time or
/// impulse by a relative `kEventShare`.
// a thousandth of a pixel, and a million times the round-off of a short run
inline constexpr double kApart = 1e-6;
inline constexpr double kEventShare = 1e-6;

/// @pre both runs are of the scene
/// @param radius_m  by body: of its bounding ball about the origin; infinite for planes
Comparison compare(const scene::Scene& scene, const std::vector<double>& radius_m,
                   const Trajectory& a, const std::string& label_a, const Trajectory& b,
                   const std::string& label_b);

/// Name in a list of events: "collision", "comes to rest", ...
const char* name_of_event(EventKind kind);

}  // namespace tumble::report
