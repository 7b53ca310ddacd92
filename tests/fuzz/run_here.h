/// What `tumble run FILE --modules reference --engine WORD --json --trajectory FILE` does, without starting the program: for a child that
/// was forked, so that ten thousand scenes need not load ten thousand programs.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::fuzz {

/// Loads the reference's laws; called once, before the first child.
void load_laws();

/// Where a run of this record leaves a byte for each frame as it goes.
std::filesystem::path progress_of(const std::filesystem::path& record);

/// Writes the result as JSON to `out`, the recorded run to `record`, words to stderr.
/// @return the exit code that the program would end with
int run_here(const std::filesystem::path& scene_file, const std::string& engine, const std::filesystem::path& record);

}  // namespace tumble::fuzz
