#include "framework/report/engines_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/report/html.h"

namespace tumble::report {
namespace {

Plot against_n(const std::string& title, const std::string& quantity, const std::string& unit, const std::vector<std::vector<EngineRow>>& ladder, double (*value)(const EngineRow&), const std::string& caption) {
  Plot plot;
  plot.title = title;
  plot.x = {"bodies", "", Scale::kLog};
  plot.y = {quantity, unit, Scale::kLog};
  plot.caption = caption;
  std::map<std::string, std::size_t> places;
  for (const auto& rows : ladder)
    for (const EngineRow& row : rows) {
      if (!row.stopped_by.empty()) continue;
      const auto [place, is_new] = places.try_emplace(row.label, plot.curves.size());
      if (is_new) plot.curves.push_back({row.label + ": " + row.meaning, {}, {}, true});
      plot.curves[place->second].x.push_back(row.bodies);
      plot.curves[place->second].y.push_back(value(row));
    }
  return plot;
}

}  // namespace

std::uint64_t count_of(const EngineRow& row, const std::string& name) {
  const auto found = row.counts.find(name);
  return found == row.counts.end() ? 0 : found->second;
}

const std::vector<std::pair<std::string, std::string>>& compared_counts() {
  static const std::vector<std::pair<std::string, std::string>> counts = {
      {"integrations", "Integrations"}, {"undone_integrations", "Undone"},        {"pair_checks", "Pair checks"}, {"root_findings", "Root findings"}, {"rollbacks", "Rollbacks"},
      {"anti_messages", "Anti-messages"}, {"states_kept", "States kept"}, {"discontinuities", "Discontinuities"}};
  return counts;
}

std::vector<Plot> plots_against_n(const std::vector<std::vector<EngineRow>>& ladder) {
  return {against_n("Average integration step", "step", "s", ladder,
                    [](const EngineRow& row) { return row.bodies * row.simulated_s / std::max<double>(1.0, static_cast<double>(count_of(row, "integrations"))); },
                    "Simulated time a body divided by integrations. An engine whose bodies all stop at each discontinuity of any takes shorter steps the more bodies there are."),
          against_n("Work a body and simulated second", "integrations", "1/s", ladder,
                    [](const EngineRow& row) { return static_cast<double>(count_of(row, "integrations")) / (row.bodies * row.simulated_s); },
                    "A flat curve means that a body costs what its own discontinuities cost, whatever the others do."),
          against_n("Time", "CPU time a simulated second", "s", ladder, [](const EngineRow& row) { return row.cpu_s / row.simulated_s; }, "On this machine, in this run.")};
}

Plot plot_of_energy(const std::vector<EngineRow>& rows) {
  Plot plot;
  plot.title = "Error of the energy";
  plot.x = {"time", "s"};
  plot.y = {"|E - E0| / (kinetic + |potential|)", "", Scale::kLog};
  for (const EngineRow& row : rows)
    if (!row.frame_times.empty()) plot.curves.push_back({row.label + ": " + row.meaning, row.frame_times, row.energy_error, false});
  plot.caption = "For a scene in which something is lost on purpose (restitution below 1) this is what was lost.";
  return plot;
}

Table table_of_engines(const std::vector<EngineRow>& rows) {
  const auto quickest = std::min_element(rows.begin(), rows.end(), [](const EngineRow& x, const EngineRow& y) { return (x.stopped_by.empty() ? x.cpu_s : 1e300) < (y.stopped_by.empty() ? y.cpu_s : 1e300); });
  // One column an engine: there are few of them.
  Table table;
  table.columns = {{""}};
  for (const EngineRow& row : rows) table.columns.push_back({row.label, true});
  const auto line = [&](const std::string& name, const auto& cell_of) {
    std::vector<Cell> cells{{name}};
    for (const EngineRow& row : rows) cells.push_back(row.counts.empty() ? Cell{"\u2013", "", Look::kMuted} : cell_of(row));
    table.rows.push_back(std::move(cells));
  };
  for (const auto& [name, heading] : compared_counts()) line(heading, [&](const EngineRow& row) { return Cell{std::to_string(count_of(row, name))}; });
  line("Undone of integrations", [](const EngineRow& row) { return Cell{fmt::format("{:.1f} %", 100.0 * static_cast<double>(count_of(row, "undone_integrations")) / std::max<double>(1.0, static_cast<double>(count_of(row, "integrations"))))}; });
  line("w h", [](const EngineRow& row) { return Cell{fmt::format("{:.3g}", row.w_h)}; });
  line("CPU time", [](const EngineRow& row) { return Cell{fmt::format("{:.3g} s", row.cpu_s)}; });
  line("Time, against the quickest", [&](const EngineRow& row) { return Cell{fmt::format("{:.2f}", row.cpu_s / quickest->cpu_s)}; });
  return table;
}

void write_engines_page(const std::string& title, const std::string& about, const std::vector<EngineRow>& rows, const std::vector<std::vector<EngineRow>>& ladder, const std::string& record,
                        const std::filesystem::path& file) {
  Page page("Engines side by side", title);
  if (!about.empty()) page.paragraph(about);
  page.table(table_of_engines(rows));
  for (const EngineRow& row : rows) {
    const std::string what = row.label + " (" + row.meaning + "): ";
    if (row.stopped_by.empty()) page.paragraph(what + row.agreement + ".");
    else page.paragraph(what + (row.counts.empty() ? "not run: " : "stopped ") + row.stopped_by, row.counts.empty() ? Look::kMuted : Look::kBad);
  }
  page.paragraph("An integration takes one body from one time to another; undone ones were taken back. A pair check looks for the first impact of one pair in an interval. w h is the number of "
                 "discontinuities a body and largest step: where n w h is above 2, engines whose bodies all stop at each discontinuity begin to pay for every other body.", Look::kMuted);
  if (!ladder.empty()) {
    page.heading("Against the number of bodies");
    for (const Plot& plot : plots_against_n(ladder)) page.plot(plot);
  }
  page.heading("Energy");
  page.plot(plot_of_energy(rows));
  page.record(record);
  page.write(file);
}

}  // namespace tumble::report
