#include "framework/cli/sweep_page.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/record.h"
#include "framework/core/files.h"
#include "framework/core/text.h"
#include "framework/report/html.h"

namespace tumble::cli {
namespace {

using nlohmann::ordered_json;
using report::Curve;
using report::Plot;
using report::Scale;

constexpr std::size_t kMostCurves = 16;  // that can be told apart
constexpr std::size_t kMostRows = 400;   // on the page; table.csv has all
const std::string kTime = "cpu";         // the measure that is a time

/// The word that a plot goes over: the first that is a number.
std::size_t axis_of(const Swept& swept) {
  std::size_t axis = 0;
  while (axis < swept.varied.size() && !swept.varied[axis].is_number) ++axis;
  return axis;
}

/// Values over at least a decade are drawn by their logarithm.
bool is_wide(const Varied& varied) {
  const auto [low, high] = std::minmax_element(varied.numbers.begin(), varied.numbers.end());
  return *low > 0.0 && *high >= 10.0 * *low;
}

std::string name_of_curve(const Swept& swept, const GridPoint& point, std::size_t axis) {
  std::string name;
  for (std::size_t i = 0; i < swept.varied.size(); ++i)
    if (i != axis)
      name += fmt::format("{}{} {}", name.empty() ? "" : ", ", swept.varied[i].word,
                          value_in_words(swept.varied[i], point[i]));
  return name;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string safe = "\"";
  for (const char c : text) safe += c == '"' ? std::string("\"\"") : std::string(1, c);
  return safe + '"';
}

std::string shown(double value) { return std::isfinite(value) ? few_digits(value, 4) : ""; }

// Between which values a measure lies in the points that are fine, and where; nothing where it is
// the same in all of them, or of a time.
std::string range_of(const Swept& swept, std::size_t m) {
  std::vector<std::size_t> fine;
  for (std::size_t i = 0; i < swept.points.size(); ++i)
    if (swept.results[i].state == PointState::kFine && std::isfinite(swept.results[i].values[m]))
      fine.push_back(i);
  if (fine.empty() || swept.measures[m].word == kTime) return "";
  const auto [low, high] =
      std::minmax_element(fine.begin(), fine.end(), [&](std::size_t i, std::size_t j) {
        return swept.results[i].values[m] < swept.results[j].values[m];
      });
  const auto told = [&](std::size_t i) {
    const std::string unit = swept.measures[m].unit;
    return fmt::format("{}{} ({})", shown(swept.results[i].values[m]),
                       unit.empty() ? "" : " " + unit,
                       name_of_curve(swept, swept.points[i], swept.varied.size()));
  };
  if (swept.results[*low].values[m] == swept.results[*high].values[m]) return "";
  return fmt::format("{}: from {} to {}.", capitalised(swept.measures[m].title), told(*low),
                     told(*high));
}

report::Look look_of(PointState state) {
  return state == PointState::kFine ? report::Look::kGood : report::Look::kBad;
}

report::Table table_of(const Swept& swept) {
  report::Table table;
  table.caption = "Every point of the grid.";
  for (const Varied& varied : swept.varied)
    table.columns.push_back(
        {varied.unit.empty() ? varied.word : fmt::format("{} [{}]", varied.word, varied.unit),
         varied.is_number});
  for (const Measure& measure : swept.measures)
    table.columns.push_back(
        {measure.unit.empty() ? measure.word : fmt::format("{} [{}]", measure.word, measure.unit),
         true});
  table.columns.push_back({"Run"});
  // Where not all fit, those that are not fine come first.
  std::vector<std::size_t> order(swept.points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  if (order.size() > kMostRows) {
    std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
      return swept.results[i].state != PointState::kFine;
    });
    order.resize(kMostRows);
    table.caption =
        fmt::format("{} of {} points, first those that are not fine; table.csv has all.", kMostRows,
                    swept.points.size());
  }
  for (const std::size_t i : order) {
    const PointResult& result = swept.results[i];
    std::vector<report::Cell> row;
    for (std::size_t k = 0; k < swept.varied.size(); ++k)
      row.push_back({value_in_words(swept.varied[k], swept.points[i][k])});
    for (std::size_t k = 0; k < swept.measures.size(); ++k)
      row.push_back({result.values.empty() ? "" : shown(result.values[k])});
    row.push_back({result.reason.empty() ? name_of(result.state)
                                         : name_of(result.state) + ": " + result.reason,
                   "", look_of(result.state)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::size_t count_of(const Swept& swept, PointState state) {
  return static_cast<std::size_t>(
      std::count_if(swept.results.begin(), swept.results.end(),
                    [&](const PointResult& result) { return result.state == state; }));
}

std::vector<Plot> plots_of(const Swept& swept) {
  std::vector<Plot> plots;
  const std::size_t axis = axis_of(swept);
  if (axis == swept.varied.size()) return plots;
  const Varied& over = swept.varied[axis];
  const bool is_log = is_wide(over);
  for (std::size_t m = 0; m < swept.measures.size(); ++m) {
    const Measure& measure = swept.measures[m];
    // How an error or a price falls with a step is a power of it.
    const bool is_change = measure.word == "energy" && is_log;
    const bool is_log_y = measure.is_error || is_change || (measure.word == kTime && is_log);
    Plot plot;
    plot.title = measure.title;
    plot.title.front() = static_cast<char>(std::toupper(plot.title.front()));
    plot.x = {over.word, over.unit, is_log ? Scale::kLog : Scale::kLinear};
    plot.y = {is_change ? "size of the change of energy" : measure.title, measure.unit,
              is_log_y ? Scale::kLog : Scale::kLinear};
    std::map<std::string, std::size_t> places;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < swept.points.size(); ++i) {
      const std::string name = name_of_curve(swept, swept.points[i], axis);
      const auto [place, is_new] = places.try_emplace(name, plot.curves.size());
      if (is_new) plot.curves.push_back({name, {}, {}, true});
      const PointResult& result = swept.results[i];
      const bool is_fine = result.state == PointState::kFine;
      left_out += is_fine ? 0 : 1;
      const double value = is_fine ? result.values[m] : kUnset;
      plot.curves[place->second].x.push_back(over.numbers[swept.points[i][axis]]);
      plot.curves[place->second].y.push_back(is_change ? std::abs(value) : value);
    }
    for (Curve& curve : plot.curves) curve = report::sorted_by_x(std::move(curve));
    if (plot.curves.size() > kMostCurves) {
      plot.caption = fmt::format("The first {} of {} curves. ", kMostCurves, plot.curves.size());
      plot.curves.resize(kMostCurves);
    }
    if (left_out > 0)
      plot.caption += fmt::format(
          "{} points are left out, which stopped, cannot be trusted or are missing: the table says "
          "why.",
          left_out);
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::string csv_of(const Swept& swept) {
  std::string text;
  for (const Varied& varied : swept.varied) text += quoted(varied.word) + ',';
  for (const Measure& measure : swept.measures)
    if (measure.word != kTime) text += quoted(measure.word) + ',';
  text += "run,reason\n";
  for (std::size_t i = 0; i < swept.points.size(); ++i) {
    const PointResult& result = swept.results[i];
    for (std::size_t k = 0; k < swept.varied.size(); ++k)
      text += quoted(swept.varied[k].texts[swept.points[i][k]]) + ',';
    for (std::size_t k = 0; k < swept.measures.size(); ++k) {
      if (swept.measures[k].word == kTime) continue;
      if (!result.values.empty() && std::isfinite(result.values[k]))
        text += fmt::format("{}", result.values[k]);
      text += ',';
    }
    text += name_of(result.state) + ',' + quoted(result.reason) + '\n';
  }
  return text;
}

ordered_json json_of(const Swept& swept) {
  ordered_json all{{"scene", swept.scene.name},
                   {"scene_digest", swept.scene.digest},
                   {"seeds", swept.scene.seeds},
                   {"laws", swept.laws}};
  for (const Varied& varied : swept.varied)
    all["over"].push_back({{"word", varied.word}, {"unit", varied.unit}, {"values", varied.texts}});
  for (const Measure& measure : swept.measures)
    if (measure.word != kTime)
      all["measures"].push_back(
          {{"word", measure.word}, {"title", measure.title}, {"unit", measure.unit}});
  all["points"] = ordered_json::array();
  for (std::size_t i = 0; i < swept.points.size(); ++i) {
    const PointResult& result = swept.results[i];
    ordered_json row;
    for (std::size_t k = 0; k < swept.varied.size(); ++k) {
      const Varied& varied = swept.varied[k];
      const std::size_t at = swept.points[i][k];
      if (varied.is_number)
        row[varied.word] = varied.numbers[at];
      else
        row[varied.word] = varied.texts[at];
    }
    for (std::size_t k = 0; k < swept.measures.size(); ++k)
      if (swept.measures[k].word != kTime)
        row["measured"][swept.measures[k].word] = result.values.empty() ? kUnset : result.values[k];
    row["run"] = name_of(result.state);
    row["reason"] = result.reason;
    all["points"].push_back(std::move(row));
  }
  return all;
}

void write_sweep(const Context& context, const Swept& swept, const std::filesystem::path& folder) {
  const auto dump = [](const ordered_json& json) {
    return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + '\n';
  };
  ordered_json table{{"version", kProgramVersion}};
  table.update(json_of(swept));
  write_whole(folder / "table.json", dump(table));
  write_whole(folder / "table.csv", csv_of(swept));
  ordered_json times{{"command", context.command_line}, {"version", kProgramVersion}};
  for (const PointResult& result : swept.results) times["cpu_s"].push_back(result.cpu_s);
  write_whole(folder / "times.json", dump(times));

  std::string words;
  double cpu_s = 0.0;
  for (const Varied& varied : swept.varied)
    words += fmt::format("{}{} ({} value{})", words.empty() ? "" : ", ", varied.word, varied.size(),
                         varied.size() == 1 ? "" : "s");
  for (const PointResult& result : swept.results)
    if (std::isfinite(result.cpu_s)) cpu_s += result.cpu_s;
  report::Page page(swept.scene.title, "A sweep over " + words);
  page.tiles({{"points", {fmt::format("{}", swept.points.size())}},
              {"fine", {fmt::format("{}", count_of(swept, PointState::kFine))}},
              {"stopped", {fmt::format("{}", count_of(swept, PointState::kStopped))}},
              {"not trusted", {fmt::format("{}", count_of(swept, PointState::kNotTrusted))}},
              {"missing", {fmt::format("{}", count_of(swept, PointState::kMissing))}}});
  page.paragraph(fmt::format("{}; {:.3g} s of CPU time in all.", swept.laws, cpu_s));
  if (!swept.lost.empty()) page.paragraph(swept.lost, report::Look::kBad);
  for (std::size_t m = 0; m < swept.measures.size(); ++m)
    if (const std::string range = range_of(swept, m); !range.empty()) page.paragraph(range);
  const std::vector<Plot> plots = plots_of(swept);
  if (!plots.empty()) page.heading("Curves");
  for (const Plot& plot : plots) page.plot(plot);
  page.heading("Table");
  page.table(table_of(swept));
  page.links({{"table.csv", report::link_to("table.csv")},
              {"table.json", report::link_to("table.json")},
              {"times.json", report::link_to("times.json")}});
  page.record(record_of(context, swept.scene));
  page.write(folder / "index.html");
}

}  // namespace tumble::cli
