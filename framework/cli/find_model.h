/// Models by what a person calls them.
#pragma once

#include <filesystem>
#include <string>

#include "framework/cli/command.h"

namespace tumble::cli {

/// A .3ds file by its path, or by its name in models/ with or without its ending; the word itself
/// where there is none.
std::filesystem::path find_model_file(const Command& command, const std::string& word);

}  // namespace tumble::cli
