#include "framework/report/engines_model.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace tumble::report {
namespace {

double measured_integrations(const EngineRow& row) {
  return static_cast<double>(count_of(row, "integrations")) / row.simulated_s;
}

bool ran(const EngineRow& row) { return row.stopped_by.empty() && row.simulated_s > 0; }

}  // namespace

std::optional<double> modelled_integrations(const std::string& engine, double n, double w,
                                            double h) {
  const double lambda = 0.5 * n * w;
  if (engine == "rd") {
    const double p = -std::expm1(-lambda * h);
    return n * lambda * (1.0 + p) / p;
  }
  if (engine == "ca") return n * (1.0 / h + 3.0 * lambda);
  if (engine == "tw") return n * (1.0 / h + 3.0 * w);
  return std::nullopt;
}

double discontinuities_a_body(const std::vector<EngineRow>& rows) {
  double w = 0.0;
  for (const EngineRow& row : rows)
    if (ran(row) && (w == 0.0 || row.engine != "rd")) w = row.w_h / row.step_s;
  return w;
}

namespace {

/// Each run that the model has a number for: visit(row, w, model).
template <class Visit>
void for_each_modelled(const std::vector<std::vector<EngineRow>>& ladder, const Visit& visit) {
  for (const auto& rows : ladder) {
    const double w = discontinuities_a_body(rows);
    if (!(w > 0)) continue;
    for (const EngineRow& row : rows)
      if (const auto model = modelled_integrations(row.engine, row.bodies, w, row.step_s);
          model && ran(row))
        visit(row, w, *model);
  }
}

}  // namespace

Plot plot_of_model(const std::vector<std::vector<EngineRow>>& ladder) {
  Plot plot;
  plot.title = "The model of cost, and measured counts";
  plot.x = {"bodies", "", Scale::kLog};
  plot.y = {"integrations per simulated second", "1/s", Scale::kLog};
  plot.caption =
      "With marks: counted. Without: our model at each size's own number of discontinuities per "
      "body and second.";
  std::map<std::string, std::pair<std::size_t, std::size_t>> places;
  for_each_modelled(ladder, [&](const EngineRow& row, double, double model) {
    const auto [place, is_new] =
        places.try_emplace(row.label, plot.curves.size(), plot.curves.size() + 1);
    if (is_new) {
      plot.curves.push_back({row.label + ", counted", {}, {}, true});
      plot.curves.push_back({row.label + ", model", {}, {}, false});
    }
    const auto add = [&](std::size_t curve, double y) {
      plot.curves[curve].x.push_back(row.bodies);
      plot.curves[curve].y.push_back(y);
    };
    add(place->second.first, measured_integrations(row));
    add(place->second.second, model);
  });
  return plot;
}

std::string place_beside_model(const std::vector<std::vector<EngineRow>>& ladder) {
  std::vector<std::pair<std::string, std::pair<double, double>>> ranges;  // by engine, in order
  for_each_modelled(ladder, [&](const EngineRow& row, double, double model) {
    const double ratio = measured_integrations(row) / model;
    std::string engine = row.engine;
    for (char& letter : engine) letter = static_cast<char>(std::toupper(letter));
    const auto known = std::find_if(ranges.begin(), ranges.end(),
                                    [&](const auto& range) { return range.first == engine; });
    if (known == ranges.end()) {
      ranges.push_back({engine, {ratio, ratio}});
    } else {
      known->second.first = std::min(known->second.first, ratio);
      known->second.second = std::max(known->second.second, ratio);
    }
  });
  std::string text;
  for (const auto& [engine, range] : ranges) {
    const auto [least, most] = range;
    const std::string from = fmt::format("{:.2f}", least), to = fmt::format("{:.2f}", most);
    text += fmt::format("{} {} {}, {}", text.empty() ? " Counted over model here:" : ";", engine,
                        from == to ? from : from + " to " + to,
                        least > 1.0   ? "above it"
                        : most <= 1.0 ? "below it"
                                      : "on both sides of it");
  }
  return text.empty() ? "" : text + '.';
}

Table table_of_model(const std::vector<std::vector<EngineRow>>& ladder) {
  Table table;
  table.caption = "Integrations per simulated second: by the model, and counted.";
  table.columns = {{"Bodies", true}, {"Engine"},        {"w [1/s]", true},        {"n w h", true},
                   {"Model", true},  {"Counted", true}, {"Counted / model", true}};
  for_each_modelled(ladder, [&](const EngineRow& row, double w, double model) {
    const double counted = measured_integrations(row);
    table.rows.push_back({{std::to_string(row.bodies)},
                          {row.label},
                          {fmt::format("{:.2f}", w)},
                          {fmt::format("{:.1f}", row.bodies * w * row.step_s)},
                          {fmt::format("{:.0f}", model)},
                          {fmt::format("{:.0f}", counted)},
                          {fmt::format("{:.2f}", counted / model)}});
  });
  return table;
}

}  // namespace tumble::report
