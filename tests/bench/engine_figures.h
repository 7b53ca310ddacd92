/// The figures by which timewarp is judged (its goals are in engine_figures.cpp): each measured in
/// one run, with its goal, w h and a picture.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::testing {

/// Measures all, prints one table, writes one page with the table and a picture per figure.
/// @param only  one chapter, by its name; empty: all
/// @return whether every goal is reached
bool measure_figures(const std::filesystem::path& page, const std::string& only = "");

}  // namespace tumble::testing
