/// Finds the submissions in a folder.
#pragma once

#include <filesystem>

#include "framework/grading/grades/grade.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

/// One submission per sub-folder, or per file in a flat folder from Canvas
/// (STUDENT_ID_ID_FILE.cpp). Symbolic links are not followed. The content of a submission never
/// causes an exception.
/// @throws UserError when `folder` is not a folder or holds no submission
FoundSubmissions find_submissions(const std::filesystem::path& folder,
                                  const modules::ModuleKind& kind);

}  // namespace tumble::grading
