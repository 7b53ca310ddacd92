/// Files that are kept from one run to the next: compiled modules for own tests (BUILD/own_tests),
/// results of an audit (BUILD/audit).
///
/// A file says itself whether it is whole: its first line is the SHA-256 of its name and of the
/// bytes behind that line. So a file that was cut short, changed, or put in the place of another
/// counts as missing, and is made again. It protects against accidents: who may write there may
/// change the judge, too.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace tumble::grading {

/// Keeps bytes under this name. @throws UserError when the file cannot be written
void keep_file(const std::filesystem::path& file, const std::string& bytes);

/// The bytes that were kept under this name; nothing where there is no file, or it is not whole.
std::optional<std::string> kept_file(const std::filesystem::path& file);

}  // namespace tumble::grading
