/// What must hold of a tree that students get: it is whole, its stubs are stubs, and it gives nothing private away.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::grading {

/// Something that stands in the way of a release.
struct Finding {
  std::string where;     // "file:line", from the root of the tree
  std::string problem;
};

/// Shipped files that need one that is not shipped: each is found by its name (an #include, a list of sources, a scene's model).
/// @param shipped, left_out  from `root`
std::vector<Finding> missing_files(const std::filesystem::path& root, const std::vector<std::filesystem::path>& shipped, const std::vector<std::filesystem::path>& left_out);

/// A stub's file holds, beside includes, namespaces and comments, one definition of each function, whose body is one line that
/// throws NotImplemented with its name.
/// @param name  of the file, for people
std::vector<Finding> what_is_no_stub(const std::string& name, const std::string& text, const std::vector<std::string>& functions);

/// A private file, and how much of it may stand in a public one too.
struct PrivateFile {
  std::filesystem::path file;   // from the root: solutions_private/...
  std::string text;
  bool is_test = false;         // a hidden test: it may share its fixture's idiom with public tests
  std::vector<std::string> places = {};   // "file:line" of each line, where they are not the file's own: of a text made of several
};

/// Compares all shipped text with all private text: whole files, three lines of code in a row, and long rows of tokens, which
/// other spaces, line ends and comments do not hide. What a module's header says anyway is no secret. Other names for the
/// same variables hide a passage: this finds copies, not retellings.
/// @param folder  the tree that is to be released
std::vector<Finding> leaks(const std::filesystem::path& folder, const std::vector<PrivateFile>& secrets);

}  // namespace tumble::grading
