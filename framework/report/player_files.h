/// The page's own sources, framework/report/player/*, as they were when this program was built. Internal to framework/report.
#pragma once

#include <string_view>

namespace tumble::report {

/// @param name  "stage.js";  @return empty: there is no such file
std::string_view player_file(std::string_view name);

}  // namespace tumble::report
