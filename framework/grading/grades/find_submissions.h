/// Finds the submissions in a folder.
#pragma once

#include <filesystem>
#include <optional>

#include "framework/grading/grades/grade.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

/// One submission per sub-folder, or per file in a flat folder from Canvas
/// (STUDENT_ID_ID_FILE.cpp). Symbolic links are not followed. The content of a submission never
/// causes an exception.
/// @param shard  Only its own submissions are looked into; of the others the name alone is right.
///               So 10^3 shards do not each open 10^5 folders of a file server.
/// @throws UserError when `folder` is not a folder or holds no submission
FoundSubmissions find_submissions(const std::filesystem::path& folder,
                                  const modules::ModuleKind& kind,
                                  const std::optional<Shard>& shard = {});

}  // namespace tumble::grading
