/// The page's sources, framework/report/player/*, embedded when this program was built. Internal to
/// framework/report.
#pragma once

#include <string_view>

namespace tumble::report {

/// @param name  e.g. "stage.js"
/// @return empty where there is no such file
std::string_view player_file(std::string_view name);

}  // namespace tumble::report
