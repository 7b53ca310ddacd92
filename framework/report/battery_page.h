/// The page of the stability battery: one table, then each hard case with its numbers, their reasons and its plots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/report/battery_row.h"

namespace tumble::report {

/// @param subtitle  which lengths were run, on whose laws
/// @param record    command and version
/// @throws UserError when the file cannot be written
void write_battery_page(const std::vector<BatteryRow>& rows, const std::string& subtitle, const std::string& record, const std::filesystem::path& file);

}  // namespace tumble::report
