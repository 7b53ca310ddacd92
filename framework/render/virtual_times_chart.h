/// A timewarp scheduler's moves as a chart for print: local virtual times as bars, rollbacks as
/// cuts, global virtual time as a line.
/// (The page of a run has the same chart, interactive: report/virtual_times_panel.h.)
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/trajectory/virtual_times.h"

namespace tumble::render {

struct ChartOptions {
  // one chart for each: the state after so many moves; empty: before and after the first rollbacks
  std::vector<std::size_t> moves;
  double from_s = 0.0, to_s = 0.0;  // interval of virtual time; equal: all [s]
  std::string title;
  int width = 900;  // pixels
};

/// Charts below each other. Dark: committed; light: ahead of global virtual time; hatched: undone
/// by rollbacks since the previous chart, with a cut at the time rolled back to.
/// @throws UserError when there is no move, or options.moves has one that does not exist
void write_virtual_times_chart(const std::filesystem::path& png, const VirtualTimes& times,
                               const ChartOptions& options);

}  // namespace tumble::render
