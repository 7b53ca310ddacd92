/// The figures that timewarp is judged by (its goals stand in engine_figures.cpp): each measured in one run, with its goal, w h and a picture.
#pragma once

#include <filesystem>

namespace tumble::testing {

/// Measures all, prints one table, writes one page with the table and a picture a figure. @return whether every figure is reached
bool measure_figures(const std::filesystem::path& page);

}  // namespace tumble::testing
