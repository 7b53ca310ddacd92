/// The measures of the kinds of checks on a recorded run (defined in judge.h). For judge.cpp and
/// the measures' own files only.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "framework/effects/effect.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

using scene::CheckSpec;
using scene::Scene;

/// The worst value of a check.
struct Finding {
  double value = 0.0;
  std::string detail;
  double rounding = 0.0;  // the rounding error of a value that is compared with a bound

  /// Keeps the larger value; NaN is worse than anything.
  void worst(double candidate, const std::string& where) {
    if (std::isnan(value) || candidate <= value) return;
    value = candidate;
    detail = where;
  }
};

/// @pre the run has a frame
using Measure = std::function<Finding(const CheckSpec&, const Scene&, const Trajectory&)>;

std::string at_time(double time);

/// @throws UserError when the run has no body of that name
int index_of(const std::string& name, const Trajectory& run);

/// The frame recorded at an instant; 0 is the end; nullptr where none was recorded then.
const Frame* frame_at(double time, const Trajectory& run);

// Links and contacts (measures_links.cpp)
/// The worst error of the links that the check names, over all frames: of the kind that the effect
/// declares (Effect::link_checks).
Finding link_error(const effects::Effect& effect, const CheckSpec&, const Scene&,
                   const Trajectory&);
Finding link_force(const CheckSpec&, const Scene&, const Trajectory&);
Finding reaction(const CheckSpec&, const Scene&, const Trajectory&);

// Bodies at rest, sliding bodies, falling bodies (measures_rest.cpp)
Finding drift(const CheckSpec&, const Scene&, const Trajectory&);
Finding tilt(const CheckSpec&, const Scene&, const Trajectory&);
Finding at_rest(const CheckSpec&, const Scene&, const Trajectory&);
Finding distance_travelled(const CheckSpec&, const Scene&, const Trajectory&);
Finding centre_of_mass(const CheckSpec&, const Scene&, const Trajectory&);
Finding angle_at(const CheckSpec&, const Scene&, const Trajectory&);
Finding stands(const CheckSpec&, const Scene&, const Trajectory&);
Finding falls(const CheckSpec&, const Scene&, const Trajectory&);
Finding order_of_falls(const CheckSpec&, const Scene&, const Trajectory&);

}  // namespace tumble::engines
