#include "framework/report/tables_json.h"

#include <nlohmann/json.hpp>

namespace tumble::report {

using Json = nlohmann::ordered_json;

namespace {

template <class Row>
Json array_of(const std::vector<Row>& rows) {
  Json all = Json::array();
  for (const Row& row : rows) all.push_back(json_of(row));
  return all;
}

}  // namespace

Json json_of(const Table& table) {
  Json rows = Json::array();
  for (const auto& cells : table.rows) {
    Json row = Json::object();
    for (std::size_t i = 0; i < cells.size(); ++i)
      row[i < table.columns.size() ? table.columns[i].name : std::to_string(i)] = cells[i].text;
    rows.push_back(std::move(row));
  }
  return {{"caption", table.caption}, {"rows", std::move(rows)}};
}

Json json_of(const CostPage& page) {
  Json curves = Json::array();
  for (const CostCurve& curve : page.curves) {
    Json points = Json::array();
    for (const CostPoint& point : curve.points)
      points.push_back({{"fineness", point.fineness},
                        {"step", point.step},
                        {"error", point.error},
                        {"cpu_s", point.cpu_s},
                        {"evaluations", point.evaluations},
                        {"stopped_by", point.stopped_by}});
    curves.push_back({{"name", curve.name},
                      {"reading", curve.reading},
                      {"order", curve.order},
                      {"counted", curve.counted.empty() ? page.counted : curve.counted},
                      {"points", std::move(points)}});
  }
  return {{"title", page.title},           {"truth", page.truth},
          {"error_name", page.error_name}, {"error_unit", page.error_unit},
          {"floor", page.floor},           {"readings", page.readings},
          {"not_run", page.not_run},       {"curves", std::move(curves)}};
}

Json json_of(const BatteryRow& row) {
  Json measures = Json::array();
  for (const Measure& m : row.measures) {
    const bool has_value = m.not_run.empty() && m.error.empty();
    const std::string note = !m.error.empty()     ? m.error
                             : !m.not_run.empty() ? m.not_run
                                                  : m.shortfall;
    measures.push_back({{"what", m.what},
                        {"value", has_value ? Json(m.value) : Json()},
                        {"threshold", m.threshold},
                        {"holds_when", m.is_question ? "equal"
                                       : m.at_least  ? "at least"
                                                     : "at most"},
                        {"unit", m.unit},
                        {"must_fail", m.must_fail},
                        {"outcome", word_of(outcome_of(m))},
                        {"note", note}});
  }
  return {{"row", row.row},
          {"name", row.name},
          {"outcome", word_of(outcome_of(row))},
          {"not_part", row.not_part},
          {"measures", std::move(measures)}};
}

Json json_of(const EngineRow& row) {
  Json parts = Json::object();
  for (const auto& [part, share] : row.time_parts) parts[part] = share;
  return {{"engine", row.engine},
          {"label", row.label},
          {"meaning", row.meaning},
          {"bodies", row.bodies},
          {"step_s", row.step_s},
          {"mean_step_s", mean_step_s(row)},
          {"simulated_s", row.simulated_s},
          {"cpu_s", row.cpu_s},
          {"discontinuities_per_body_and_step", row.w_h},
          {"counts", row.counts},
          {"time_shares", std::move(parts)},
          {"agreement", row.agreement},
          {"stopped_by", row.stopped_by},
          {"faults", row.faults}};
}

Json json_of(const std::vector<BatteryRow>& rows) { return array_of(rows); }
Json json_of(const std::vector<EngineRow>& rows) { return array_of(rows); }

}  // namespace tumble::report
