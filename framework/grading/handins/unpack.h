/// Unpacks zip archives: those that a platform gives for a whole class, and those that students
/// hand in. What is not taken is named, with the reason.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/zip.h"

namespace tumble::grading {

/// Of a class: 1,000 students with a hundred files each.
inline constexpr ZipLimits kClassZip{
    .entries = 65'000, .bytes_each = 256u << 20, .bytes_all = 4ull << 30};
/// Of a student: a source with all that an editor and a build leave beside it.
inline constexpr ZipLimits kStudentZip{
    .entries = 2'000, .bytes_each = 16u << 20, .bytes_all = 64u << 20};
/// Of the archive itself.
inline constexpr std::uint64_t kClassZipBytes = 1ull << 30, kStudentZipBytes = 32u << 20;

/// Unpacks an archive of many submissions into an empty folder. Entries that are refused are not
/// there.
/// @return refused entries, each with the reason
/// @throws UserError when the archive as a whole is refused: names it, the entry and the reason
std::vector<ZipFault> unpack_class(const std::filesystem::path& archive,
                                   const std::filesystem::path& folder);

/// Unpacks what one student handed in. Nothing of an archive with a fault is used.
/// @return why it is refused, for its author; empty: it is unpacked
std::string unpack_submission(const std::filesystem::path& archive,
                              const std::filesystem::path& folder);

/// "src/a.cpp is a symbolic link": a fault in words, safe to show.
std::string in_words(const ZipFault& fault);

}  // namespace tumble::grading
