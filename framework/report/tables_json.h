/// What pages show as tables and curves, for other programs. A number that is not finite is null.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "framework/report/battery_row.h"
#include "framework/report/cost_page.h"
#include "framework/report/engines_page.h"
#include "framework/report/html.h"

namespace tumble::report {

/// {"caption", "rows": one object a row, its cells' texts by the names of the columns}
nlohmann::ordered_json json_of(const Table& table);

/// {"title", "truth", "floor", "readings", "not_run", "curves": name, reading, order, points}
nlohmann::ordered_json json_of(const CostPage& page);

/// {"row", "name", "outcome", "measures": what, value, threshold, unit, outcome, note}
nlohmann::ordered_json json_of(const BatteryRow& row);

/// {"engine", "bodies", "step_s", "simulated_s", "cpu_s", "counts", "agreement", "stopped_by",
/// "faults"}
nlohmann::ordered_json json_of(const EngineRow& row);

/// An array of each row's.
nlohmann::ordered_json json_of(const std::vector<BatteryRow>& rows);
nlohmann::ordered_json json_of(const std::vector<EngineRow>& rows);

}  // namespace tumble::report
