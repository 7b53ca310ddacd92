/// `tumble new assignment`: every file of an assignment, with what only its author can write marked
/// "(to be written: ...)".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/extend/templates.h"

namespace tumble::extend {

/// @param id    "a5"
/// @param name  "plausible": the folder is a5_plausible
/// @param functions_file  see declarations.h
/// @return what was written, below the root
/// @throws UserError for an id or name that is taken or cannot be one, and as read_declarations
std::vector<NewFile> new_assignment(const std::filesystem::path& root, const std::string& id,
                                    const std::string& name,
                                    const std::filesystem::path& functions_file);

/// The folder of an assignment below assignments/: "a5_plausible".
/// @throws UserError naming those that there are
std::string folder_of_assignment(const std::filesystem::path& root, const std::string& id);

}  // namespace tumble::extend
