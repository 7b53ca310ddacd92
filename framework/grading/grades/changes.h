/// What a regrade changed, and how results are put in place.
#pragma once

#include <filesystem>
#include <optional>

#include "framework/grading/grades/grade_files.h"

namespace tumble::grading {

/// Fills `change` and `changes` of a new grade: which test has another result than before, and why.
void note_changes(const GradeRecord& old, const GradeKey& key, Grade& now);

/// Keeps the pictures of an earlier run where none are made now: their files always, and on the
/// page if the earlier record describes them.
/// @param place  the folder of the earlier results
/// @param made   the folder of the new ones
void keep_media(const std::filesystem::path& place, const std::filesystem::path& made,
                const std::optional<GradeRecord>& earlier, Grade& grade, GradeKey& key);

/// Puts a finished folder in place. A reader sees the whole old folder or the whole new one: they
/// are exchanged atomically where the file system can.
/// @param aside  where the old folder may be put
void put_in_place(const std::filesystem::path& made, const std::filesystem::path& place,
                  const std::filesystem::path& aside);

}  // namespace tumble::grading
