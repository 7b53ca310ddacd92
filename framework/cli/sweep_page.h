/// What `tumble sweep` leaves: a page, and tables for programs. table.csv and table.json hold no
/// times and no command, so that they are the same bytes for any --jobs and on any machine; CPU
/// times stand in times.json and on the page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "framework/cli/sweep_points.h"
#include "framework/report/plot.h"

namespace tumble::cli {

struct Swept {
  scene::Scene scene;
  std::string laws;  // whose they are, in words
  std::vector<Varied> varied;
  std::vector<Measure> measures;
  std::vector<GridPoint> points;
  std::vector<PointResult> results;  // by point
  std::string lost;                  // what is missing, in words; empty: nothing
};

/// How many points ended so.
std::size_t count_of(const Swept& swept, PointState state);

/// A plot for each measure over the first word that is a number, a curve for each value of the
/// others; none where no word is one. Points that are not fine break a curve.
std::vector<report::Plot> plots_of(const Swept& swept);

/// A row for each point: the values of its words, its measures but times, how it ended and why.
std::string csv_of(const Swept& swept);
nlohmann::ordered_json json_of(const Swept& swept);

/// @throws UserError when a file cannot be written
void write_sweep(const Context& context, const Swept& swept, const std::filesystem::path& folder);

}  // namespace tumble::cli
