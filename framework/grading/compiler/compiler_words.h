/// The output of the compiler and the linker for a student's file, in a helpful order: the
/// student's own line first.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::grading {

/// Only the errors, with the place in the student's file first. An error inside a library's
/// template (Eigen's size checks) is shown at the student's line from which it is "required", with
/// the library's message below. A function that the module's header declares and the file does not
/// define is named with its declaration and the place of that.
/// @param said    the compiler's output
/// @param source  the student's file, for the lines that are shown
/// @param header  of the module; empty: missing functions are named without their declaration
/// @return the output itself, cut short, where no known error is in it
std::string compiler_story(const std::string& said, const std::filesystem::path& source,
                           const std::filesystem::path& header = {});

/// The file that a line of code includes in quotes; empty where it includes none.
std::string included_in_quotes(const std::string& line);

/// Why a file defines nothing of a module, as the compiler says errors: it does not so much as name
/// the module's header. Empty where it does.
/// @param name  of the file  @param header  of the module, from the root of the tree
std::string why_nothing(const std::string& name, const std::string& text,
                        const std::filesystem::path& header);

/// The warnings in the student's file, at most ten; empty where there is none.
std::string compiler_warnings(const std::string& said, const std::filesystem::path& source);

}  // namespace tumble::grading
