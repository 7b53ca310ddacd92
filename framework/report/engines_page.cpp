#include "framework/report/engines_page.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "framework/report/html.h"

namespace tumble::report {
namespace {

Plot against_n(const std::string& title, const std::string& quantity, const std::string& unit,
               const std::vector<std::vector<EngineRow>>& ladder, double (*value)(const EngineRow&),
               const std::string& caption) {
  Plot plot;
  plot.title = title;
  plot.x = {"bodies n", "", Scale::kLog};
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

double mean_step_s(const EngineRow& row) {
  return row.bodies * row.simulated_s /
         std::max<double>(1.0, static_cast<double>(count_of(row, "integrations")));
}

const std::vector<std::pair<std::string, std::string>>& compared_counts() {
  static const std::vector<std::pair<std::string, std::string>> counts = {
      {"integrations", "Integrations"},
      {"undone_integrations", "Undone"},
      {"pair_checks", "Pair checks"},
      {"root_findings", "Root findings"},
      {"rollbacks", "Rollbacks"},
      {"anti_messages", "Anti-messages"},
      {"states_kept", "States kept"},
      {"discontinuities", "Discontinuities"},
      {"sliding_changes", "Sliding changes"}};
  return counts;
}

std::vector<Plot> plots_against_n(const std::vector<std::vector<EngineRow>>& ladder) {
  return {
      against_n("Average integration step", "step", "s", ladder, mean_step_s,
                "Simulated time per body divided by integrations. The steps of an engine that "
                "stops all bodies at every discontinuity shrink with the number of bodies."),
      against_n(
          "Work per body and simulated second", "integrations", "1/s", ladder,
          [](const EngineRow& row) {
            return static_cast<double>(count_of(row, "integrations")) /
                   (row.bodies * row.simulated_s);
          },
          "A flat curve means that the cost of a body depends only on its own discontinuities."),
      against_n(
          "Time", "CPU time per simulated second", "s", ladder,
          [](const EngineRow& row) { return row.cpu_s / row.simulated_s; },
          "On this machine, in this run.")};
}

std::vector<StackedBars> bars_of_work(const std::vector<EngineRow>& rows) {
  StackedBars integrations{"Integrations",
                           {"integrations"},
                           {"kept", "undone"},
                           {},
                           "One integration advances one body from one time to another. Undone: "
                           "rolled back, but paid for."};
  StackedBars checks{
      "Pair checks", {"pair checks"}, {"searched for their first impact in an interval"}, {}};
  StackedBars time{"CPU time", {"CPU time", "ms"}, {"of a run without pictures"}, {}};
  for (const EngineRow& row : rows) {
    if (row.counts.empty() || !row.stopped_by.empty()) continue;
    const double all = static_cast<double>(count_of(row, "integrations")),
                 undone = static_cast<double>(count_of(row, "undone_integrations"));
    integrations.rows.push_back({row.label, {std::max(0.0, all - undone), undone}});
    checks.rows.push_back({row.label, {static_cast<double>(count_of(row, "pair_checks"))}});
    time.rows.push_back({row.label, {1e3 * row.cpu_s}});
  }
  return {integrations, checks, time};
}

StackedBars bars_of_time(const std::vector<EngineRow>& rows) {
  StackedBars bars;
  bars.title = "Where the time went";
  bars.axis = {"share of each engine's time", "%"};
  std::string physics, too_short;
  for (const EngineRow& row : rows) {
    const double sum = std::accumulate(row.time_parts.begin(), row.time_parts.end(), 0.0,
                                       [](double x, const auto& part) { return x + part.second; });
    if (!(sum > 0)) {
      if (!row.counts.empty())
        too_short += (too_short.empty() ? " Too short to measure: " : ", ") + row.label;
      continue;
    }
    if (bars.parts.empty())
      for (const auto& [name, share] : row.time_parts) bars.parts.push_back(name);
    bars.rows.push_back({fmt::format("{}, {:.3g} s", row.label, row.cpu_s), {}});
    for (const auto& [name, share] : row.time_parts)
      bars.rows.back().values.push_back(100.0 * share);
    physics += fmt::format("{}{:.0f} % of {}'s", physics.empty() ? "" : ", ", 100.0 * row.physics,
                           row.label);
  }
  bars.caption = fmt::format(
      "By samples of the stack. Contacts, links, motion, impacts and the search for them are "
      "physics, which all engines compute by the same functions: {}. Only the rest depends on how "
      "an engine schedules the bodies.{}",
      physics, too_short.empty() ? "" : too_short + ".");
  return bars;
}

Plot plot_of_energy(const std::vector<EngineRow>& rows) {
  Plot plot;
  plot.title = "Error of the energy";
  plot.x = {"time", "s"};
  plot.y = {"|E − E(0)| / (kinetic + |potential|)", "", Scale::kLog};
  for (const EngineRow& row : rows)
    if (!row.frame_times.empty())
      plot.curves.push_back(
          {row.label + ": " + row.meaning, row.frame_times, row.energy_error, false});
  plot.caption =
      "Where energy is lost or added by the physics (restitution below 1, friction, effects that "
      "slow bodies down or drive them), this includes the energy lost or added.";
  return plot;
}

namespace {

std::vector<EngineRow>::const_iterator fastest_of(const std::vector<EngineRow>& rows) {
  return std::min_element(rows.begin(), rows.end(), [](const EngineRow& x, const EngineRow& y) {
    return (x.stopped_by.empty() ? x.cpu_s : 1e300) < (y.stopped_by.empty() ? y.cpu_s : 1e300);
  });
}

std::string headline_of(const std::vector<EngineRow>& rows) {
  std::string others;
  const auto fastest = fastest_of(rows);
  for (auto row = rows.begin(); row != rows.end(); ++row)
    if (row != fastest && row->stopped_by.empty())
      others += fmt::format("{} {} {:.3g} times as long", others.empty() ? "" : ",", row->label,
                            row->cpu_s / fastest->cpu_s);
  if (others.empty()) return "";
  return fmt::format("{} takes the least time in this run:{}.", fastest->label, others);
}

}  // namespace

Table table_of_engines(const std::vector<EngineRow>& rows) {
  const auto fastest = fastest_of(rows);
  // One column per engine, because there are few.
  Table table;
  table.columns = {{""}};
  for (const EngineRow& row : rows) table.columns.push_back({row.label, true});
  const auto line = [&](const std::string& name, const auto& cell_of) {
    std::vector<Cell> cells{{name}};
    for (const EngineRow& row : rows)
      cells.push_back(row.counts.empty() ? Cell{"\u2013", "", Look::kMuted} : cell_of(row));
    table.rows.push_back(std::move(cells));
  };
  for (const auto& [name, heading] : compared_counts())
    line(heading, [&](const EngineRow& row) { return Cell{std::to_string(count_of(row, name))}; });
  line("Integrations undone", [](const EngineRow& row) {
    return Cell{fmt::format(
        "{:.1f} %", 100.0 * static_cast<double>(count_of(row, "undone_integrations")) /
                        std::max<double>(1.0, static_cast<double>(count_of(row, "integrations"))))};
  });
  line("w h", [](const EngineRow& row) { return Cell{fmt::format("{:.3g}", row.w_h)}; });
  line("CPU time", [](const EngineRow& row) { return Cell{fmt::format("{:.3g} s", row.cpu_s)}; });
  line("Time, relative to the fastest", [&](const EngineRow& row) {
    return Cell{fmt::format("{:.2f}", row.cpu_s / fastest->cpu_s)};
  });
  return table;
}

void write_engines_page(const std::string& title, const std::string& about,
                        const std::vector<EngineRow>& rows,
                        const std::vector<std::vector<EngineRow>>& ladder,
                        const std::string& record, const std::filesystem::path& file) {
  Page page("Engines side by side", title);
  if (const std::string headline = headline_of(rows); !headline.empty())
    page.paragraph(headline, Look::kGood);
  if (!about.empty()) page.paragraph(about);
  page.table(table_of_engines(rows));
  for (const EngineRow& row : rows) {
    const std::string what = row.label + " (" + row.meaning + "): ";
    if (row.stopped_by.empty())
      page.paragraph(what + row.agreement + ".");
    else
      page.paragraph(what + (row.counts.empty() ? "not run: " : "stopped ") + row.stopped_by,
                     row.counts.empty() ? Look::kMuted : Look::kBad);
    if (!row.faults.empty())
      page.paragraph(row.label + " cannot be trusted: " + row.faults + ".", Look::kBad);
  }
  page.paragraph(
      "An integration advances one body from one time to another; undone ones were rolled back. A "
      "pair check searches for the first impact of one pair in an interval. w h is the number of "
      "discontinuities per body and largest step: where n w h is above 2, stopping all bodies at "
      "every discontinuity becomes costly. A change between sliding and sticking or rolling is a "
      "discontinuity "
      "in the lecture; here it is not in w h, because no engine ends a step of all bodies for it: "
      "the contact problem of one island finds it. Retroactive detection counts it separately.",
      Look::kMuted);
  if (!ladder.empty()) {
    page.heading("Against the number of bodies");
    for (const Plot& plot : plots_against_n(ladder)) page.plot(plot);
  }
  page.heading("Work and time");
  for (const StackedBars& bars : bars_of_work(rows))
    if (!bars.rows.empty()) page.plot(bars);
  if (const StackedBars bars = bars_of_time(rows); !bars.rows.empty()) page.plot(bars);
  page.heading("Energy");
  page.plot(plot_of_energy(rows));
  page.record(record);
  page.write(file);
}

}  // namespace tumble::report
