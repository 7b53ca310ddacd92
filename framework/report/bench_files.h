/// The bench's sources, framework/report/bench/*, embedded when this program was built. Internal to
/// framework/report.
#pragma once

#include <string_view>

namespace tumble::report {

/// @param name  e.g. "host.js"
/// @return empty where there is no such file
std::string_view bench_file(std::string_view name);

}  // namespace tumble::report
