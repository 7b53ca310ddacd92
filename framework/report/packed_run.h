/// A recorded run as channels for a player's page. Internal to framework/report.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "framework/report/played_run.h"
#include "framework/scene/scene.h"

namespace tumble::report {

/// One curve over the frames of a run.
struct Series {
  std::string plot, name, unit;    // plot: "energy", "drift", "momentum", ...: curves of one plot share axes
  std::vector<double> values;      // by frame that is kept; not finite: missing
};

struct PackedRun {
  nlohmann::ordered_json head;     // what the page must know to read the channels
  std::string channels;            // deflated
  std::vector<double> times_s;     // of the frames that are kept
  std::vector<Series> series;
};

/// @param apart_m   by frame, or empty: a curve more, from a comparison
/// @param sight_m   distance from the eye to what it looks at: places are kept to a millionth of it
PackedRun pack_run(const scene::Scene& scene, const PlayedRun& played, const std::vector<double>& apart_m, double sight_m, const PlayerOptions& options);

}  // namespace tumble::report
