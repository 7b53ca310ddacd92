/// Files made from the templates of framework/extend/templates.
///
/// A template ends in `.in`; its path below its folder is the path of the file below the root.
/// `@mark@` stands for a value, in the path and in the text. Lines between `@each function@` and
/// `@end@`, each alone on its line, are repeated with the marks of each function.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tumble::extend {

using Marks = std::map<std::string, std::string>;

struct NewFile {
  std::filesystem::path file;  // below the root
  std::string text;
};

/// @param where  of the template, for messages
/// @throws UserError with file and line for a mark that has no value, or a repeat without its end
std::string filled(const std::string& text, const Marks& marks, const std::vector<Marks>& functions,
                   const std::string& where);

/// Every template below a folder, filled in, by path.
std::vector<NewFile> files_from(const std::filesystem::path& templates, const Marks& marks,
                                const std::vector<Marks>& functions = {});

/// Puts new files into the tree: all of them or none. They are written into a draft folder at the
/// root and renamed, assignments/ last, because a folder there is an assignment from then on.
/// C++ is formatted where clang-format is installed.
/// @throws UserError when one of them is there already, or cannot be written
void put_in_place(const std::filesystem::path& root, const std::vector<NewFile>& files);

}  // namespace tumble::extend
