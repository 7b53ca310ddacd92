/// Checks of a tree for students: it is complete, its stubs are stubs, and it contains nothing
/// private.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::grading {

/// A problem that prevents a release.
struct ReleaseFault {
  std::string where;  // "file:line", from the root of the tree
  std::string problem;
};

/// Shipped files that need a file that is not shipped, found by its name (an #include, a list of
/// sources, a scene's model).
/// @param shipped, left_out  from `root`
std::vector<ReleaseFault> missing_files(const std::filesystem::path& root,
                                        const std::vector<std::filesystem::path>& shipped,
                                        const std::vector<std::filesystem::path>& left_out);

/// A stub's file may have, beside includes, namespaces and comments, only one definition of each
/// function, whose body is one line that throws NotImplemented with its name.
/// @param name  of the file, for messages
std::vector<ReleaseFault> what_is_no_stub(const std::string& name, const std::string& text,
                                          const std::vector<std::string>& functions);

/// A private file.
struct PrivateFile {
  std::filesystem::path file;  // from the root: solutions_private/...
  std::string text;
  bool is_test = false;  // a hidden test, which may share fixtures with public tests
  // "file:line" of each line, where they are not the file's own: of a text made of several
  std::vector<std::string> places = {};
};

/// Compares all shipped text with all private text: whole files, three consecutive lines of code,
/// and long sequences of tokens, which different spaces, line ends and comments do not hide. Text
/// of a module's header is not secret. Renamed variables hide a passage: this finds copies, not
/// rewritten code.
/// @param folder  the tree that is to be released
std::vector<ReleaseFault> leaks(const std::filesystem::path& folder,
                                const std::vector<PrivateFile>& secrets);

}  // namespace tumble::grading
