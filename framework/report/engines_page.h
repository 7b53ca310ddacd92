/// The page that puts engines side by side on one scene: what each counted, how long it took against the others, whether they agree.
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
  std::string engine, meaning;                 // "tw", "timewarp"
  std::string label;                           // what a column or a curve is called: "rd", "RD-1/30"
  int bodies = 0;                              // movable
  double step_s = 0.0;                         // the largest
  double simulated_s = 0.0, cpu_s = 0.0;
  double w_h = 0.0;                            // discontinuities a body and step
  std::map<std::string, std::uint64_t> counts; // of the run's counters
  std::vector<double> frame_times, energy_error;   // |E - E0| / scale, by frame
  std::vector<std::pair<std::string, double>> time_parts;   // shares of the CPU time, in the same parts for every engine; all 0: too short to tell
  double physics = 0.0;                        // of them together what is done by the same functions for all engines
  std::string agreement;                       // with the first engine that goes event by event, in words
  std::string stopped_by;                      // also why it did not run
  std::string faults;                          // why the run is not to be trusted, in words; empty: it is
};

/// The counts that are compared, in order: name in Counters, heading.
const std::vector<std::pair<std::string, std::string>>& compared_counts();

/// How far one integration takes one body on the average: simulated time a body over integrations, those undone too. [s]
double mean_step_s(const EngineRow& row);

/// Nothing counted: 0.
std::uint64_t count_of(const EngineRow& row, const std::string& name);

/// One column an engine: counts, w h, undone part, time against the quickest.
Table table_of_engines(const std::vector<EngineRow>& rows);

/// What each engine counted and how long it took, a bar an engine: integrations kept and undone, pair checks, CPU time.
std::vector<StackedBars> bars_of_work(const std::vector<EngineRow>& rows);
/// Where each engine's time went, in shares. No rows where no run was long enough to tell.
StackedBars bars_of_time(const std::vector<EngineRow>& rows);

/// Of a ladder of sizes: work and time against the number of bodies, a curve an engine; steps are counted as integrations.
std::vector<Plot> plots_against_n(const std::vector<std::vector<EngineRow>>& ladder);
/// Error of the energy against time, a curve an engine.
Plot plot_of_energy(const std::vector<EngineRow>& rows);

/// @param rows    of the scene that the page is about
/// @param ladder  rows of other sizes of the scene, ascending; empty where it has one size
/// @throws UserError when the file cannot be written
void write_engines_page(const std::string& title, const std::string& about, const std::vector<EngineRow>& rows, const std::vector<std::vector<EngineRow>>& ladder, const std::string& record,
                        const std::filesystem::path& file);

}  // namespace tumble::report
