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
  // plot: "energy", "drift", "momentum", ...: curves of one plot share axes
  std::string plot, name, unit;
  std::vector<double> values;  // by kept frame; not finite: missing
};

struct PackedRun {
  nlohmann::ordered_json head;  // needed to read the channels
  std::string channels;         // deflated
  std::vector<double> times_s;  // of the kept frames
  std::vector<Series> series;
};

/// @param apart_m   by frame, or empty: an additional curve, from a comparison
/// @param sight_m   distance from the eye to its target: positions are stored to a millionth of it
PackedRun pack_run(const scene::Scene& scene, const PlayedRun& played,
                   const std::vector<double>& apart_m, double sight_m,
                   const PlayerOptions& options);

}  // namespace tumble::report
