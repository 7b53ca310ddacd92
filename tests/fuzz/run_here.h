/// `tumble run FILE --modules reference --engine WORD --json --trajectory FILE` without starting
/// the program: for a forked child, so that ten thousand scenes need not load ten thousand
/// programs.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::fuzz {

/// Loads the reference's laws; called once, before the first child.
void load_laws();

/// The file to which a run of this record writes a byte for each frame.
std::filesystem::path progress_of(const std::filesystem::path& record);

/// Writes the result as JSON to `out`, the recorded run to `record`, messages to stderr.
/// @return the exit code of the program
int run_here(const std::filesystem::path& scene_file, const std::string& engine,
             const std::filesystem::path& record);

}  // namespace tumble::fuzz
