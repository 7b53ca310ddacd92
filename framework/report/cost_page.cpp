#include "framework/report/cost_page.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/report/html.h"

namespace tumble::report {
namespace {

constexpr double kExact = 1e-17;  // [m] or [-]: where an error of exactly 0 is drawn

/// Runs that did not finish, or whose error is too large, are not drawn.
bool is_drawn(const CostPage& page, const CostPoint& point) {
  return point.stopped_by.empty() && point.error < page.scale;
}

const std::string& counted_by(const CostPage& page, const CostCurve& curve) {
  return curve.counted.empty() ? page.counted : curve.counted;
}

/// @param counting  draws only the curves with this counted quantity; empty: all
Plot drawn(const CostPage& page, Axis across, const std::string& title,
           double (*x)(const CostPoint&), const std::string& caption,
           const std::string& counting = "") {
  Plot plot{title,  std::move(across), {page.error_name, page.error_unit, Scale::kLog}, {}, {},
            caption};
  for (const CostCurve& curve : page.curves) {
    Curve line{std::isfinite(curve.order) ? fmt::format("{}, order {:.2f}", curve.name, curve.order)
                                          : curve.name,
               {},
               {},
               true};
    for (const CostPoint& point : curve.points) {
      if (!is_drawn(page, point) || !(x(point) > 0) ||
          (!counting.empty() && counted_by(page, curve) != counting))
        continue;
      line.x.push_back(x(point));
      // errors below the error floor cannot be resolved
      line.y.push_back(std::max({point.error, page.floor, kExact}));
    }
    // keeps its place, so that a method has the same style in all plots
    if (line.x.empty()) line.name.clear();
    plot.curves.push_back(sorted_by_x(std::move(line)));
  }
  if (page.error_unit.empty()) plot.limits.push_back({1.0, "right below"});
  if (page.floor > 0) plot.limits.push_back({page.floor, "error of the reference solution"});
  return plot;
}

Plot plot_of_energy(const CostPage& page) {
  Plot plot{"Energy against time, at about the same cost",
            {"time", "s"},
            {page.error_unit.empty() ? "|E − E at the start| / energy"
                                     : "|E − E of the reference| / energy",
             "-", Scale::kLog},
            {},
            {},
            "Each curve is the run of its method whose cost is closest to the median of all: "};
  std::string which;
  bool is_any_exact = false;
  for (const CostCurve& curve : page.curves) {
    plot.curves.push_back(
        {curve.times.empty() ? "" : curve.name, curve.times, curve.energy_errors});
    for (double& error : plot.curves.back().y) {
      is_any_exact |= error < kExact;
      error = std::max(error, kExact);
    }
    if (!curve.times.empty())
      which += fmt::format("{}{} ({})", which.empty() ? "" : ", ", curve.name,
                           curve.points[curve.example].fineness);
  }
  plot.caption += which + ".";
  if (is_any_exact) plot.caption += fmt::format(" A difference of 0 is drawn at {:g}.", kExact);
  return plot;
}

/// With hyphens and blanks that do not break: "tolerance 1e-08" and "1/240 s" stay on one line.
std::string unbroken(const std::string& fineness) {
  std::string kept;
  for (const char letter : fineness)
    kept += letter == '-' ? "\u2011" : letter == ' ' ? "\u00a0" : std::string(1, letter);
  return kept;
}

Table table_of_prices(const CostPage& page) {
  Table table;
  table.caption =
      "CPU time for an error of at most this much, and the setting that reaches it. \u2013: not "
      "reached.";
  if (page.error_unit.empty())
    table.caption = std::string("CPU time for a run that is right by all its numbers") +
                    (page.marks.size() > 1 ? ", or uses a tenth of what they allow" : "") +
                    ", and the setting that reaches it. \u2013: not reached.";
  const bool any_order =
      std::any_of(page.curves.begin(), page.curves.end(),
                  [](const CostCurve& curve) { return std::isfinite(curve.order); });
  table.columns = {{""}};
  if (any_order) table.columns.push_back({"order", true});
  for (const double mark : page.marks)
    table.columns.insert(table.columns.end(), {{mark_in_words(page, mark), true}, {"by"}});
  for (const CostCurve& curve : page.curves) {
    std::vector<Cell> cells{{curve.name}};
    if (any_order)
      cells.push_back({std::isfinite(curve.order) ? fmt::format("{:.2f}", curve.order) : "\u2013"});
    for (const double mark : page.marks) {
      const CostPoint* point = cheapest(curve, mark);
      double best = std::numeric_limits<double>::infinity();
      for (const CostCurve& other : page.curves)
        if (const CostPoint* theirs = cheapest(other, mark)) best = std::min(best, theirs->cpu_s);
      if (point == nullptr)
        cells.insert(cells.end(), {{"\u2013", "", Look::kMuted}, {""}});
      else
        cells.insert(cells.end(), {{price_of(point->cpu_s), "",
                                    point->cpu_s <= best ? Look::kGood : Look::kPlain},
                                   {unbroken(point->fineness), "", Look::kMuted}});
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// A part too narrow for its number is told, too: CPU times hold it.
std::string what_recording_takes(const StackedBars& bars) {
  const auto stage = std::find(bars.parts.begin(), bars.parts.end(), "recording");
  if (stage == bars.parts.end() || bars.rows.empty()) return "";
  const auto part = static_cast<std::size_t>(stage - bars.parts.begin());
  const auto [least, most] = std::minmax_element(
      bars.rows.begin(), bars.rows.end(),
      [&](const auto& a, const auto& b) { return a.values[part] < b.values[part]; });
  const std::string from = fmt::format("{:.0f}", least->values[part]),
                    to = fmt::format("{:.0f}", most->values[part]);
  return fmt::format(
      "Recording keeps the frames in which errors and energies are read. Every CPU time on this "
      "page holds it: {}% of these runs.",
      from == to ? to + " " : from + " to " + to + " ");
}

/// Stages of each curve's example, the same runs as in the plot of energies.
StackedBars bars_of_stages(const CostPage& page) {
  std::set<std::string> stages;  // with any time
  for (const CostCurve& curve : page.curves)
    for (const auto& [stage, seconds] : curve.stage_seconds)
      if (seconds > 0) stages.insert(stage);
  StackedBars bars;
  bars.title = "Where the time of the same runs went";
  bars.axis = {"share of the stages' total time", "%"};
  bars.parts.assign(stages.begin(), stages.end());
  for (const CostCurve& curve : page.curves) {
    const double all =
        std::accumulate(curve.stage_seconds.begin(), curve.stage_seconds.end(), 0.0,
                        [](double sum, const auto& stage) { return sum + stage.second; });
    if (!(all > 0)) continue;
    bars.rows.push_back(
        {fmt::format("{}, {}", curve.name, curve.points[curve.example].fineness), {}});
    for (const std::string& stage : stages) {
      const auto found = curve.stage_seconds.find(stage);
      bars.rows.back().values.push_back(
          found == curve.stage_seconds.end() ? 0.0 : std::max(0.0, 100.0 * found->second / all));
    }
  }
  bars.caption = what_recording_takes(bars);
  return bars;
}

Table table_of_points(const CostPage& page) {
  Table table;
  table.columns = {{""},
                   {"by"},
                   {page.error_unit.empty() ? "error" : "error [" + page.error_unit + "]", true},
                   {"CPU", true},
                   {"evaluations", true}};
  bool any_stopped = false;
  for (const CostCurve& curve : page.curves)
    for (const CostPoint& point : curve.points)
      if (point.stopped_by.empty()) {
        table.rows.push_back({{curve.name},
                              {unbroken(point.fineness), "", Look::kMuted},
                              {few_digits(point.error, 3)},
                              {price_of(point.cpu_s)},
                              {fmt::format("{:.0f}", point.evaluations)}});
      } else {
        any_stopped = true;
        table.rows.push_back({{curve.name},
                              {unbroken(point.fineness), "", Look::kMuted},
                              {"\u2013"},
                              {""},
                              {""},
                              {point.stopped_by, "", Look::kMuted}});
      }
  if (any_stopped) {
    table.columns.push_back({"stopped by"});
    for (auto& row : table.rows) row.resize(table.columns.size());
  }
  return table;
}

}  // namespace

std::vector<std::size_t> not_beaten(const std::vector<double>& price,
                                    const std::vector<double>& error) {
  std::vector<std::size_t> best;
  for (std::size_t i = 0; i < price.size(); ++i) {
    bool beaten = !std::isfinite(price[i]) || !std::isfinite(error[i]);
    for (std::size_t j = 0; j < price.size() && !beaten; ++j)
      beaten = price[j] < price[i] && error[j] <= error[i];
    if (!beaten) best.push_back(i);
  }
  std::sort(best.begin(), best.end(),
            [&](std::size_t i, std::size_t j) { return price[i] < price[j]; });
  return best;
}

const CostPoint* cheapest(const CostCurve& curve, double error) {
  const CostPoint* best = nullptr;
  for (const CostPoint& point : curve.points)
    if (point.stopped_by.empty() && point.error <= error &&
        (best == nullptr || point.cpu_s < best->cpu_s))
      best = &point;
  return best;
}

std::string mark_in_words(const CostPage& page, double mark) {
  if (!page.error_unit.empty())
    return fmt::format("1e{:.0f} {}", std::log10(mark), page.error_unit);
  return mark == 1.0 ? "right" : fmt::format("{:g} of allowed", mark);
}

std::string price_of(double seconds) {
  if (!std::isfinite(seconds)) return "\u2013";
  // costs are known to two digits
  const double rounded = std::stod(fmt::format("{:.1e}", seconds));
  if (rounded < 1e-3) return fmt::format("{:g} \u00b5s", 1e6 * rounded);
  return rounded < 1.0 ? fmt::format("{:g} ms", 1e3 * rounded) : fmt::format("{:g} s", rounded);
}

Plot plot_of_price(const CostPage& page) {
  std::string caption =
      "Left is cheaper, down is more accurate. The error of a method of order p falls by p decades "
      "where its cost rises by one.";
  const auto is_below_floor = [&](const CostPoint& point) {
    return is_drawn(page, point) && point.error < page.floor;
  };
  if (std::any_of(page.curves.begin(), page.curves.end(), [&](const CostCurve& curve) {
        return std::any_of(curve.points.begin(), curve.points.end(), is_below_floor);
      }))
    caption += " An error smaller than that of the reference solution is drawn as large as it.";
  return drawn(
      page, {"CPU time", "s", Scale::kLog}, "Error against CPU time",
      [](const CostPoint& point) { return point.cpu_s; }, caption);
}

std::vector<Plot> plots_of_evaluations(const CostPage& page) {
  std::vector<std::string> counters;
  for (const CostCurve& curve : page.curves)
    if (std::find(counters.begin(), counters.end(), counted_by(page, curve)) == counters.end())
      counters.push_back(counted_by(page, curve));
  std::vector<Plot> plots;
  for (const std::string& counter : counters) {
    Plot plot = drawn(
        page, {counter, "-", Scale::kLog},
        counters.size() > 1 ? "Error against " + counter : "Error against evaluations",
        [](const CostPoint& point) { return point.evaluations; },
        "The cost of a method on any machine. Methods without evaluations, such as closed forms, "
        "are not in this plot.",
        counter);
    if (std::any_of(plot.curves.begin(), plot.curves.end(),
                    [](const Curve& curve) { return !curve.x.empty(); }))
      plots.push_back(std::move(plot));
  }
  return plots;
}

void write_cost_page(const CostPage& cost, const std::filesystem::path& file) {
  Page page("What accuracy costs", cost.title);
  for (const CostCurve& curve : cost.curves)
    if (curve.is_subject) page.paragraph(curve.reading);
  for (const std::string& reading : cost.readings) page.paragraph(reading);
  page.plot(plot_of_price(cost));
  page.table(table_of_prices(cost));
  for (const std::string& what : cost.not_run)
    page.paragraph("Not run: " + what + ".", Look::kMuted);
  const bool by_step = cost.finer.name == "step";
  const auto has_steps = [&](const CostCurve& curve) {
    return std::any_of(curve.points.begin(), curve.points.end(), [&](const CostPoint& point) {
      return is_drawn(cost, point) && point.step > 0;
    });
  };
  page.heading(by_step ? "Order" : "Tolerance");
  if (std::any_of(cost.curves.begin(), cost.curves.end(), has_steps))
    page.plot(drawn(
        cost, cost.finer, "Error against the " + cost.finer.name,
        [](const CostPoint& point) { return point.step; },
        by_step ? "The slope is the order: halving the step divides the error of a method of order "
                  "p by 2^p. Methods that choose their own steps are not in this plot."
                : "The tolerance of a root finder, and the error it reaches. Finders without a "
                  "tolerance are not in this plot."));
  for (const CostCurve& curve : cost.curves)
    if (!curve.reading.empty()) page.paragraph(curve.reading);
  const std::vector<Plot> evaluations = plots_of_evaluations(cost);
  if (!evaluations.empty()) page.heading("Evaluations");
  for (const Plot& plot : evaluations) page.plot(plot);
  const auto has_energy = [](const CostCurve& curve) { return !curve.times.empty(); };
  if (std::any_of(cost.curves.begin(), cost.curves.end(), has_energy)) {
    page.heading("Energy");
    page.plot(plot_of_energy(cost));
    const StackedBars stages = bars_of_stages(cost);
    if (!stages.rows.empty()) page.heading("Where the time went");
    if (!stages.rows.empty()) page.plot(stages);
  }
  page.heading("How it was measured");
  page.paragraph(cost.about);
  page.paragraph(cost.what_error_is);
  if (!cost.what_price_is.empty())
    page.paragraph(cost.what_price_is);
  else
    page.paragraph(
        "CPU time is that of the engine without loading models and shapes, the best of up to five "
        "runs, with the overhead of stack samples. Only ratios are meaningful on other machines.");
  page.begin(Part::kFold, "Every run");
  page.table(table_of_points(cost));
  page.end();
  page.record(cost.record);
  page.write(file);
}

}  // namespace tumble::report
