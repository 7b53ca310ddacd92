/// The page's sources, framework/live/page/*, embedded when this program was built.
#pragma once

#include <string_view>

namespace tumble::live {

/// @param name  e.g. "live.html"
/// @return empty where there is no such file
std::string_view page_file(std::string_view name);

}  // namespace tumble::live
