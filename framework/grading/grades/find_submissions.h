/// Finds the submissions in a folder.
#pragma once

#include <filesystem>
#include <optional>

#include "framework/grading/grades/grade.h"
#include "framework/modules/registry.h"

namespace tumble::grading {

/// One submission per sub-folder, or what a platform gives to download (handins/layouts.h), as a
/// folder or as its zip archive. Symbolic links are not followed. The content of a submission never
/// causes an exception: where a part of an archive is refused, its submission says so, and the
/// others are graded.
/// @param what   a folder, or a zip archive
/// @param shard  Only its own submissions are looked into; of the others the name alone is right.
///               So 10^3 shards do not each open 10^5 folders of a file server.
/// @throws UserError when `what` is neither or holds no submission, or an archive is refused as a
///   whole
FoundSubmissions find_submissions(const std::filesystem::path& what,
                                  const modules::ModuleKind& kind,
                                  const std::optional<Shard>& shard = {});

/// The folder as one submission, named "submission".
/// @throws UserError when it is not a folder
FoundSubmissions find_submission(const std::filesystem::path& folder,
                                 const modules::ModuleKind& kind);

}  // namespace tumble::grading
