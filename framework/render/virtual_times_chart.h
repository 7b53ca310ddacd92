/// A timewarp scheduler's moves as a picture for paper: local virtual times as bars, rollbacks as cuts, global virtual time as a line.
/// (The page of a run has the same chart to step through: report/virtual_times_panel.h.)
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/trajectory/virtual_times.h"

namespace tumble::render {

struct ChartOptions {
  std::vector<std::size_t> moves;   // one chart for each: how things stand after so many moves; empty: after the first rollbacks
  double from_s = 0.0, to_s = 0.0;  // what is shown of virtual time; equal: all [s]
  std::string title;
  int width = 900;                  // pixels
};

/// Charts below each other. Dark: committed; light: ahead of global virtual time; hatched: what rollbacks undid since the chart before,
/// with a cut where they went.
/// @throws UserError when there is no move to show, or one is asked for that is not there
void write_virtual_times_chart(const std::filesystem::path& png, const VirtualTimes& times, const ChartOptions& options);

}  // namespace tumble::render
