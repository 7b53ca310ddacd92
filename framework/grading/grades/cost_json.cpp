#include "framework/grading/grades/cost_json.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace tumble::grading {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN, so it is stored as null; a plot breaks its line there.
double number_or_nan(const Json& json) {
  return json.is_null() ? std::nan("") : json.get<double>();
}

std::vector<double> numbers_of(const Json& json) {
  std::vector<double> numbers;
  for (const Json& number : json) numbers.push_back(number_or_nan(number));
  return numbers;
}

Json axis_json(const report::Axis& axis) {
  return {{"name", axis.name}, {"unit", axis.unit}, {"log", axis.scale == report::Scale::kLog}};
}
report::Axis axis_of(const Json& json) {
  return {json.at("name"), json.at("unit"),
          json.at("log") ? report::Scale::kLog : report::Scale::kLinear};
}

Json plot_json(const report::Plot& plot) {
  Json curves = Json::array(), limits = Json::array();
  for (const report::Curve& c : plot.curves)
    curves.push_back({{"name", c.name}, {"x", c.x}, {"y", c.y}, {"marks", c.marks}});
  for (const report::Limit& limit : plot.limits)
    limits.push_back({{"y", limit.y}, {"name", limit.name}});
  return {{"title", plot.title}, {"x", axis_json(plot.x)}, {"y", axis_json(plot.y)},
          {"curves", curves},    {"limits", limits},       {"caption", plot.caption}};
}

report::Plot plot_of(const Json& json) {
  report::Plot plot{json.at("title"),  axis_of(json.at("x")), axis_of(json.at("y")), {}, {},
                    json.at("caption")};
  for (const Json& c : json.at("curves"))
    plot.curves.push_back(
        {c.at("name"), numbers_of(c.at("x")), numbers_of(c.at("y")), c.at("marks")});
  for (const Json& limit : json.at("limits"))
    plot.limits.push_back({number_or_nan(limit.at("y")), limit.at("name")});
  return plot;
}

Json table_json(const report::Table& table) {
  Json columns = Json::array(), rows = Json::array();
  for (const report::Column& column : table.columns)
    columns.push_back({{"name", column.name}, {"is_number", column.is_number}});
  for (const auto& row : table.rows) {
    Json cells = Json::array();
    for (const report::Cell& cell : row)
      cells.push_back(
          {{"text", cell.text}, {"link", cell.link}, {"look", static_cast<int>(cell.look)}});
    rows.push_back(std::move(cells));
  }
  return {{"caption", table.caption}, {"columns", columns}, {"rows", rows}};
}

report::Table table_of(const Json& json) {
  report::Table table;
  table.caption = json.at("caption");
  for (const Json& column : json.at("columns"))
    table.columns.push_back({column.at("name"), column.at("is_number")});
  for (const Json& row : json.at("rows")) {
    std::vector<report::Cell> cells;
    for (const Json& cell : row)
      cells.push_back({cell.at("text"), cell.at("link"),
                       static_cast<report::Look>(cell.at("look").get<int>())});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

Json cost_json(const CostSection& cost) {
  Json lines = Json::array(), plots = Json::array(), tables = Json::array();
  for (const CostLine& line : cost.lines)
    lines.push_back({{"reading", line.reading},
                     {"is_right", line.is_right},
                     {"is_attempted", line.is_attempted},
                     {"is_wasteful", line.is_wasteful},
                     {"more", line.more}});
  for (const report::Plot& plot : cost.plots) plots.push_back(plot_json(plot));
  for (const report::Table& table : cost.tables) tables.push_back(table_json(table));
  return {{"scene", cost.scene},
          {"truth", cost.truth},
          {"lines", lines},
          {"plots", plots},
          {"tables", tables}};
}

CostSection cost_of(const Json& json) {
  CostSection cost;
  cost.scene = json.at("scene");
  cost.truth = json.at("truth");
  for (const Json& line : json.at("lines"))
    cost.lines.push_back({line.at("reading"), line.at("is_right"), line.at("is_attempted"),
                          line.at("is_wasteful"), line.value("more", std::string())});
  for (const Json& plot : json.at("plots")) cost.plots.push_back(plot_of(plot));
  for (const Json& table : json.at("tables")) cost.tables.push_back(table_of(table));
  return cost;
}

}  // namespace tumble::grading
