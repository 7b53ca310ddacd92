/// An assignment's handout as one page, for a report that links to it.
#pragma once

#include <filesystem>
#include <string>

#include "framework/grading/course/course.h"

namespace tumble::grading {

/// Name of the page in a folder of results.
inline constexpr const char* kHandoutPage = "handout.html";

/// Whether the tree has a handout for the assignment.
bool has_handout(const Course& course, const std::string& id);

/// Writes the handout as one file that needs no other: pictures inside, formulas as MathML, no link
/// out of it. Made by pandoc; where pandoc is missing or fails, the page holds the handout's text.
/// Does nothing without a handout.
/// @throws UserError when the file cannot be written
void write_handout(const Course& course, const std::string& id, const std::filesystem::path& file);

/// Puts that page into a submission's folder, which can then be handed on alone: as one more name
/// of the same file, which takes no room; as a copy where the file system gives none.
void add_handout(const std::filesystem::path& page, const std::filesystem::path& folder);

}  // namespace tumble::grading
