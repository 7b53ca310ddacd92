/// What the compiler and the linker said of a student's file, in the order in which it helps: the student's own line first.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::grading {

/// The errors alone, the place in the student's file first. An error inside a library's template (Eigen's size checks) is
/// shown at the line of the student's file that it is "required from here", with the library's message below. A function
/// that the module's header declares and the file does not define is named with what was expected and where it is declared.
/// @param said    what the compiler printed
/// @param source  the student's file; read for the lines that are shown
/// @param header  of the module, or empty: then missing functions are named without what was expected
/// @return what was said, cut short, where it holds no error that is known here
std::string compiler_story(const std::string& said, const std::filesystem::path& source, const std::filesystem::path& header = {});

/// The warnings whose place is in the student's file, at most ten; empty where there is none.
std::string compiler_warnings(const std::string& said, const std::filesystem::path& source);

}  // namespace tumble::grading
