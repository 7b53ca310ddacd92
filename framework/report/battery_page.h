/// The page of the stability battery: an overview table, then each hard case with its measures,
/// their reasons and its plots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/report/battery_row.h"

namespace tumble::report {

/// @param subtitle  length of the runs, and the laws' source
/// @param record    command and version
/// @throws UserError when the file cannot be written
void write_battery_page(const std::vector<BatteryRow>& rows, const std::string& subtitle,
                        const std::string& record, const std::filesystem::path& file);

}  // namespace tumble::report
