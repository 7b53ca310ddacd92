/// Submissions in a folder.
#pragma once

#include <filesystem>

#include "framework/grading/grades/grade.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

/// One submission a sub-folder, or a file where Canvas has put them flat (STUDENT_ID_ID_FILE.cpp). Symbolic links are not followed.
/// Never throws for what a folder holds.
/// @throws UserError when `folder` is no folder or holds no submission
FoundSubmissions find_submissions(const std::filesystem::path& folder, const modules::ModuleKind& kind);

}  // namespace tumble::grading
