/// The page that compares engines on one scene: counts, times, and whether they agree.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "framework/report/html.h"
#include "framework/report/plot.h"

namespace tumble::report {

/// One engine's run of one scene.
struct EngineRow {
  std::string engine, meaning;  // "tw", "timewarp"
  std::string label;            // name of a column or a curve: "rd", "RD-1/30"
  int bodies = 0;               // movable
  double step_s = 0.0;          // the largest
  double simulated_s = 0.0, cpu_s = 0.0;
  double w_h = 0.0;                               // discontinuities per body and step
  std::map<std::string, std::uint64_t> counts;    // of the run's counters
  std::vector<double> frame_times, energy_error;  // |E - E0| / scale, by frame
  // shares of the CPU time, in the same parts for every engine; all 0: the run was too short
  std::vector<std::pair<std::string, double>> time_parts;
  // total share of the parts that all engines compute by the same functions
  double physics = 0.0;
  std::string agreement;   // with the first event-driven engine, in words
  std::string stopped_by;  // or why it did not run
  // why the run cannot be trusted, in words; empty: it can
  std::string faults;
};

/// The compared counts in order: (name in Counters, heading).
const std::vector<std::pair<std::string, std::string>>& compared_counts();

/// Mean integration step: simulated time per body over integrations, including undone ones. [s]
double mean_step_s(const EngineRow& row);

/// A count by name; 0 where there is none.
std::uint64_t count_of(const EngineRow& row, const std::string& name);

/// One column per engine: counts, w h, fraction undone, time relative to the fastest.
Table table_of_engines(const std::vector<EngineRow>& rows);

/// Counts and times, one bar per engine: integrations kept and undone, pair checks, CPU time.
std::vector<StackedBars> bars_of_work(const std::vector<EngineRow>& rows);
/// Shares of each engine's time. No rows where all runs were too short.
StackedBars bars_of_time(const std::vector<EngineRow>& rows);

/// Work and time against the number of bodies, one curve per engine; a step of a body counts as an
/// integration.
std::vector<Plot> plots_against_n(const std::vector<std::vector<EngineRow>>& ladder);
/// Error of the energy against time, one curve per engine.
Plot plot_of_energy(const std::vector<EngineRow>& rows);

/// @param rows    of the scene
/// @param ladder  rows of the scene at several sizes, ascending; empty where it has one size
/// @throws UserError when the file cannot be written
void write_engines_page(const std::string& title, const std::string& about,
                        const std::vector<EngineRow>& rows,
                        const std::vector<std::vector<EngineRow>>& ladder,
                        const std::string& record, const std::filesystem::path& file);

}  // namespace tumble::report
