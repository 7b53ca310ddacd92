/// Reads files of reference values (JSON) into plain data.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/truths/truth_case.h"

namespace tumble::cli {

/// @throws UserError when the file cannot be read, is not JSON, or is no file of reference values;
///   later, when a value is of another kind
truths::Case read_truth(const std::filesystem::path& file);

/// The files of reference values of a folder in order of their names, or the one file given.
/// @throws UserError when there is no such folder, or no .json file in it
std::vector<std::filesystem::path> find_truths(const std::filesystem::path& folder_or_file);

}  // namespace tumble::cli
